// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <set>
#include <vector>

#include "stages/clustering/select_edges.h"

namespace psfm {

/// The neighbours of an image that are of another place than it is, as far as pairs tell (ours):
/// where two of its neighbours are known to be of different places, it cannot be of both. Each
/// neighbour is opposed by those that it is apart from, with their inliers times their
/// plausibility; of two that are apart the one with more opposition is outvoted. Depends on the
/// image's plausible pairs and on which images are apart, on no order of arrival.
/// @return ascending
std::vector<ImageId> outvoted_neighbors(const EdgeSelection& selection, ImageId image);

/// Brings the view graph in line with a selection of which parts have changed.
/// @param images  whose plausible pairs have changed, or neighbours of which are apart now or not
/// any more
/// @param pairs  that have become plausible or ceased to be, or whose images are apart now or not
/// any more
EdgeChanges apply_selection(EdgeSelection& selection, ViewGraph& graph,
                            const std::set<ImageId>& images, std::set<ImagePair> pairs);

}  // namespace psfm
