// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "graph/rigid3.h"

namespace psfm {

/// Similarity `target_from_source`: x_target = scale * rotation * x_source + translation.
/// Invariants: scale > 0, rotation has unit norm.
struct Sim3 {
    double scale = 1.0;
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
    Eigen::Vector3d translation = Eigen::Vector3d::Zero();
};

Sim3 operator*(const Sim3& c_from_b, const Sim3& b_from_a);
Sim3 inverse(const Sim3& target_from_source);

inline Eigen::Vector3d operator*(const Sim3& target_from_source, const Eigen::Vector3d& x) {
    return target_from_source.scale * (target_from_source.rotation * x) +
           target_from_source.translation;
}

/// The camera pose after its world is moved by a similarity: the camera keeps its own unit of
/// length at 1 in the new world, so the scale goes into the centre's position only.
/// @return cam_from_target, whose centre is target_from_source * (centre in source)
Rigid3 transform_pose(const Rigid3& cam_from_source, const Sim3& target_from_source);

}  // namespace psfm
