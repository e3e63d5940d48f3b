// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "graph/camera.h"
#include "graph/rigid3.h"

namespace psfm {

/// Covariance of a camera's pose from what it sees, by the reprojection errors' normal equations
/// at the pose; points and camera count as exact. First three: a small turn of the camera about its
/// own axes [rad], cam_from_world' = exp(turn) * cam_from_world; last three: its centre in the
/// world, in the world's units.
/// @param pixels  N observations [px, distorted]. @param points  N points in the world
/// @return nothing where they do not determine the pose (fewer than four in front of the camera)
/// Deterministic. Thread-safe.
std::optional<Eigen::Matrix<double, 6, 6>> pose_covariance(std::span<const Eigen::Vector2d> pixels,
                                                           std::span<const Eigen::Vector3d> points,
                                                           const Camera& camera,
                                                           const Rigid3& cam_from_world);

}  // namespace psfm
