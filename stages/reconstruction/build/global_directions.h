// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "graph/two_view_geometry.h"
#include "stages/algorithms/averaging/relative_direction.h"
#include "stages/reconstruction/model/cover_tracks.h"
#include "stages/reconstruction/model/solve_options.h"
#include "stages/reconstruction/model/working_model.h"

namespace psfm {

/// Tracks of 3 images at least along the matches of some pairs, a cover of so many an image.
std::vector<FeatureTrack> covering_tracks(const WorkingModel& model,
                                          std::span<const VerifiedPairPtr> pairs,
                                          std::uint32_t tracks_per_image);

/// What positions are averaged from: directions between images, nodes 0 … image_count - 1, and from
/// images to points, the nodes after them. Pairs come first.
struct GlobalDirections {
    std::vector<RelativeDirection> edges;
    std::vector<VerifiedPairPtr> pairs;  ///< of the first edges
    std::uint32_t node_count = 0;
};

/// @param pairs  between images of one rotation component
/// @param rotations  cam_from_cluster, by local image
GlobalDirections find_directions(const WorkingModel& model, std::span<const VerifiedPairPtr> pairs,
                                 const std::vector<Eigen::Quaterniond>& rotations,
                                 const GlobalOptions& options);

}  // namespace psfm
