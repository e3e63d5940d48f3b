// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "graph/ids.h"
#include "graph/view_graph.h"
#include "stages/clustering/clustering_options.h"

namespace psfm {

/// Clusters of a whole view graph at once, nothing held apart, and those of fewer than
/// options.join_below images joined: the definition that update_clustering and join_late are tested
/// against, and the way to look at a graph that did not grow here.
/// @return members ascending; clusters ascending by first member; each image in exactly one
std::vector<std::vector<ImageId>> batch_clusters(const ViewGraph& graph,
                                                 const ClusteringOptions& options);

}  // namespace psfm
