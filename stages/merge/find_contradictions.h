// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "graph/reconstruction.h"
#include "graph/sim3.h"
#include "graph/two_view_geometry.h"
#include "stages/merge/merge_options.h"

namespace psfm {

/// How far away is what the images of a model see: a harmonic mean over some of the points, in the
/// model's units; 0 for an image that sees nothing. By image, as in Reconstruction::images.
std::vector<double> mean_depths(const Reconstruction& model);

/// A cluster in the frame of its component.
struct PlacedModel {
    const Reconstruction* model = nullptr;
    std::span<const double> depths;  ///< mean_depths(*model)
    Sim3 component_from_cluster;
};

/// Clusters of one component that cannot both stand where they do: most cameras of one that come to
/// stand beside cameras of the other, looking the same way, share nothing with them. Not only of
/// neighbours: a small cluster of a facade that two streets have may stand right beside either.
/// @param edges  of the view graph, ascending by images; those within clusters may be left out
/// @return pairs of positions in `models`, ascending
/// Deterministic on any number of threads. Thread-safe. Cost: one search an image among all
/// centres.
std::vector<std::pair<std::uint32_t, std::uint32_t>> find_contradictions(
    std::span<const PlacedModel> models, std::span<const ImagePair> edges,
    const ClusterConstraintOptions& options);

}  // namespace psfm
