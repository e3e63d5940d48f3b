// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>

namespace psfm {

/// Direction between two centres from matched viewing rays, in a frame where the cameras' rotations
/// are known: the one across which the normals of the epipolar planes lie, by reweighted least
/// squares (the loss of Geman and McClure, its scale twice the median deviation),
/// such that most points are in front of both cameras. With two unknowns instead of five this is
/// surer than the direction that came with the pair's rotation (Ozyesil & Singer 2015, sec. 3).
/// @param rays1, rays2  N unit rays, N >= 2; rays1[i] ~ rays2[i]
/// @param start  unit vector near the solution, up to its sign
/// @return unit vector from the first centre to the second
Eigen::Vector3d direction_between(std::span<const Eigen::Vector3d> rays1,
                                  std::span<const Eigen::Vector3d> rays2,
                                  const Eigen::Vector3d& start);

}  // namespace psfm
