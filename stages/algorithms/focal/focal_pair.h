// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "graph/rigid3.h"
#include "stages/algorithms/two_view/sampson.h"

namespace psfm {

/// The focal length of one end of a pair: `known` focal lengths, or unknown parameter number
/// `parameter`.
struct FocalEnd {
    std::optional<std::size_t> parameter;
    Eigen::Vector2d known = Eigen::Vector2d::Ones();  ///< fx, fy in the unit of the points
    double unit = 1.0;  ///< focal length of relative focal length 1, in the unit of the points

    /// diag(fx, fy, 1) for the logarithms of the relative focal lengths.
    Eigen::Matrix3d intrinsic(const Eigen::VectorXd& log_focals) const;
};

/// A pair as focal calibration sees it. Points are undistorted and relative to the principal
/// points.
struct FocalPair {
    FocalEnd end1;
    FocalEnd end2;
    Eigen::Matrix3d fundamental = Eigen::Matrix3d::Zero();  ///< of the points
    std::vector<PointPair> points;                          ///< may be empty for votes
    double weight = 1.0;                                    ///< of its vote
};

/// (s1 - s2) / (s1 + s2) of the essential matrix's singular values: 0 where the focal lengths fit.
double essential_defect(const FocalPair& pair, const Eigen::VectorXd& log_focals);

}  // namespace psfm
