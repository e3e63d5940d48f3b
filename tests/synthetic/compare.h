// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>

#include "graph/reconstruction.h"
#include "graph/result.h"
#include "graph/sim3.h"
#include "tests/synthetic/scene.h"

namespace psfm::synthetic {

/// How far a reconstruction is from the truth after the best similarity.
struct ReconstructionError {
    Sim3 world_from_cluster;
    std::size_t images = 0;
    double mean_position = 0.0;  ///< of camera centres [m]
    double max_position = 0.0;   ///< [m]
    double mean_rotation_deg = 0.0;
    double max_rotation_deg = 0.0;
    std::size_t points = 0;
    double median_point =
        0.0;  ///< distance of points from the true point of most of their track [m]
    std::size_t mixed_tracks = 0;  ///< points with observations of more than one true point
};

/// Similarity that maps source to target points with least squares (Umeyama 1991). When the points
/// lie on a line (or are only two), centres do not tell the rotation about it; then `rotation_hint`
/// is used. REQUIRES: equal sizes, at least 2 points that are not all equal.
Sim3 align_points(std::span<const Eigen::Vector3d> source, std::span<const Eigen::Vector3d> target,
                  const Eigen::Quaterniond& rotation_hint);

/// Mean of rotations that lie close together: the quaternion with least squared chordal distances.
/// REQUIRES: not empty.
Eigen::Quaterniond mean_rotation(std::span<const Eigen::Quaterniond> rotations);

/// @errors kTooFewMatches (fewer than 2 images), kNotFound (an image the scene does not have)
Result<ReconstructionError> compare_with_truth(const Reconstruction& reconstruction,
                                               const SyntheticScene& scene);

}  // namespace psfm::synthetic
