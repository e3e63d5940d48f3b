// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "graph/ids.h"
#include "stages/clustering/clustering_state.h"

namespace psfm {

/// Which parts a group of images falls into after links were lost. Searches from all seeds in turn,
/// one image each; searches that meet become one, one that runs dry has found a whole part; ends
/// when a single search is left. Cost: that many steps for each of the parts found, however large
/// the rest is; if nothing fell apart, the time for the seeds to meet.
/// @param state links between images of equal cluster_of are followed, workspace.stamp is used
/// @param seeds one or more images of one cluster; REQUIRES: every part of it holds a seed (the
/// ends of all lost links do)
/// @return the parts but for one, which is as likely as not the largest; images in order of
/// discovery
std::vector<std::vector<ImageId>> find_split_parts(ClusteringState& state,
                                                   std::span<const ImageId> seeds);

}  // namespace psfm
