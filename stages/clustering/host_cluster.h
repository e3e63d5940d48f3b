// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "graph/ids.h"
#include "graph/view_graph.h"
#include "stages/clustering/clustering_state.h"

namespace psfm {

/// The cluster that an image is tried against when its own is too small to be reconstructed: the
/// one, of at least mu_min images, that it shares most correspondences with (ties: the smallest
/// id). An image at the rim of a scene has few edges, all of them into one dense cluster, and a
/// large Jaccard distance to every image there; it would wait for ever. Ours; not measured.
/// @return nothing for images of clusters that are large enough, and where there is no such
/// neighbour
std::optional<ClusterId> host_cluster(const ViewGraph& graph, const ClusteringState& clustering,
                                      ImageId image, std::uint32_t mu_min);

/// Images of small clusters whose host may be another one after some images changed cluster, got
/// new edges, or saw their cluster cross mu_min: those images and their neighbours. Ascending.
std::vector<ImageId> images_to_host_again(const ViewGraph& graph, const ClusteringState& clustering,
                                          std::span<const ImageId> changed, std::uint32_t mu_min);

}  // namespace psfm
