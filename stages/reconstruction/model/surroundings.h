// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "graph/reconstruction.h"
#include "stages/reconstruction/model/cluster_problem.h"

namespace psfm {

/// The part of a cluster that adding images to its largest recycled model can change, as a problem
/// of its own: the images that this does not have, and the other recycled models; their neighbours
/// in the view graph, with all points that these see; and whoever else sees these points, without
/// edges, so that nothing pulls at a point in the whole model and not here.
struct Surroundings {
    ClusterProblem problem;
    std::vector<std::uint8_t>
        is_inside;  ///< by point of the whole model: 1 where it is in the part
};

/// @param problem  with recycled models, the first of members only
/// @param max_points  the part has at most this share of the model's points
/// @return nothing when no member is new to it, or when the part would have more
/// Deterministic. Thread-safe. Cost: a look at each image and each block of points (PointBlock),
/// and a copy of the part.
std::optional<Surroundings> surroundings_of_new_images(const ClusterProblem& problem,
                                                       double max_points);

/// The whole model with its part replaced: points outside as they were, then those of the part.
/// Blocks of points that the part has none of are shared.
/// @param part  as it became of `surroundings.problem`'s recycled model
Reconstruction put_back(const Reconstruction& whole, const Surroundings& surroundings,
                        const Reconstruction& part);

}  // namespace psfm
