// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "graph/rigid3.h"

namespace psfm {

/// A normalised image point and the pose of its camera.
struct View {
    Rigid3 cam_from_world;
    Eigen::Vector2d normalized = Eigen::Vector2d::Zero();  ///< z = 1, undistorted
};

/// Point nearest to all views by the direct linear transform (Hartley and Zisserman, sec. 12.2).
/// Nothing when it is at infinity or behind one of the cameras. REQUIRES: at least two views.
std::optional<Eigen::Vector3d> triangulate(std::span<const View> views);

/// Angle [rad] at a point between the directions to two camera centres, in [0, pi/2].
double triangulation_angle(const Eigen::Vector3d& centre1, const Eigen::Vector3d& centre2,
                           const Eigen::Vector3d& point);

}  // namespace psfm
