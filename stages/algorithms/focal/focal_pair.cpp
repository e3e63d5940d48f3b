// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/focal/focal_pair.h"

#include <cmath>

#include "stages/algorithms/math/decompositions.h"

namespace psfm {

Eigen::Matrix3d FocalEnd::intrinsic(const Eigen::VectorXd& log_focals) const {
    if (!parameter) return Eigen::Vector3d(known.x(), known.y(), 1).asDiagonal();
    const double focal = unit * std::exp(log_focals[static_cast<Eigen::Index>(*parameter)]);
    return Eigen::Vector3d(focal, focal, 1).asDiagonal();
}

double essential_defect(const FocalPair& pair, const Eigen::VectorXd& log_focals) {
    const Eigen::Matrix3d essential =
        pair.end2.intrinsic(log_focals) * pair.fundamental * pair.end1.intrinsic(log_focals);
    const Eigen::Vector3d s = singular_values(essential).values;
    return (s[0] - s[1]) / (s[0] + s[1]);
}

}  // namespace psfm
