// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "graph/ids.h"
#include "graph/view_graph.h"
#include "stages/clustering/clustering_options.h"
#include "stages/clustering/clustering_state.h"

namespace psfm {

/// Pairs of images that became or ceased to be linked; ascending.
struct LinkChanges {
    std::vector<ImagePair> added;
    std::vector<ImagePair> removed;
};

/// Restores invariants 1 and 4 of ClusteringState after the edges of `touched` changed; leaves
/// clusters alone. REQUIRES: links, degrees and workspace sized to the graph; touched ascending,
/// without repetitions.
LinkChanges update_links(ClusteringState& state, const ViewGraph& graph,
                         std::span<const ImageId> touched, const ClusteringOptions& options);

/// Makes two images rescued neighbours, and links them. REQUIRES: an edge; they are not linked.
void set_rescued(ClusteringState& state, const ImagePair& pair);

}  // namespace psfm
