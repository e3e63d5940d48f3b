// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "graph/rigid3.h"

#include <cmath>

namespace psfm {

double rotation_angle(const Eigen::Quaterniond& rotation) {
    // atan2 keeps full precision near 0 and pi, where acos of the scalar part does not.
    return 2.0 * std::atan2(rotation.vec().norm(), std::abs(rotation.w()));
}

double angle_between(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
    return rotation_angle(a.conjugate() * b);
}

Eigen::Quaterniond rotation_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    const Eigen::Vector3d a = from.normalized();
    const Eigen::Vector3d b = to.normalized();
    const Eigen::Vector3d across = a.cross(b);
    // Where the two are nearly opposite, rounding leaves a part of it along a.
    const Eigen::Vector3d axis = across - across.dot(a) * a;
    const bool are_opposite = a.dot(b) < 0.0 && axis.norm() < 1e-12;
    Eigen::Quaterniond rotation;
    // 1 + cosine, which loses no digits where the two are nearly opposite.
    rotation.w() = are_opposite ? 0.0 : 0.5 * (a + b).squaredNorm();
    rotation.vec() = are_opposite ? a.unitOrthogonal() : axis;
    return rotation.normalized();
}

}  // namespace psfm
