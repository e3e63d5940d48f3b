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

}  // namespace psfm
