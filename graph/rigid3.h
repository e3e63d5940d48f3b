// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace psfm {

/// Rigid motion `target_from_source`: x_target = rotation * x_source + translation.
/// Invariant: rotation has unit norm. Chains cancel: c_from_a = c_from_b * b_from_a.
struct Rigid3 {
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
    Eigen::Vector3d translation = Eigen::Vector3d::Zero();

    /// Origin of the target frame, in the source frame (for cam_from_world: the camera centre).
    Eigen::Vector3d target_origin_in_source() const { return rotation.conjugate() * -translation; }
};

inline Rigid3 operator*(const Rigid3& c_from_b, const Rigid3& b_from_a) {
    return {(c_from_b.rotation * b_from_a.rotation).normalized(),
            c_from_b.rotation * b_from_a.translation + c_from_b.translation};
}

inline Eigen::Vector3d operator*(const Rigid3& target_from_source, const Eigen::Vector3d& x) {
    return target_from_source.rotation * x + target_from_source.translation;
}

inline Rigid3 inverse(const Rigid3& target_from_source) {
    return {target_from_source.rotation.conjugate(), target_from_source.target_origin_in_source()};
}

/// Angle of a rotation [rad], in [0, pi].
double rotation_angle(const Eigen::Quaterniond& rotation);

/// Angle between two rotations [rad], in [0, pi].
double angle_between(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b);

/// The least rotation that turns one direction into another; where they are opposite, half a turn
/// about some axis across. REQUIRES: neither is zero
Eigen::Quaterniond rotation_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

}  // namespace psfm
