// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "stages/algorithms/focal/focal_pair.h"

namespace psfm {

struct FocalRefinementOptions {
    double loss_scale = 1.0;  ///< of the Cauchy loss, in the unit of the points
    double pair_loss = 0.3;   ///< see FocalCalibrationOptions
    int max_iterations = 30;  ///< see FocalCalibrationOptions
};

/// Logarithms of relative focal lengths, and the relative pose of each pair with them.
struct FocalEstimate {
    Eigen::VectorXd log_focals;
    std::vector<Rigid3> poses;  ///< cam2_from_cam1, one a pair
    /// Standard deviations of log_focals, the expectation included: its deviation where no pair
    /// says anything.
    Eigen::VectorXd uncertainty;
};

/// What is expected of the focal lengths before the pairs are asked: a Gaussian in their
/// logarithms.
struct FocalExpectation {
    Eigen::VectorXd log_focals;
    double deviation = 0.1;
};

/// The pairs' poses at given focal lengths: decomposed from the fundamental matrices, refined on
/// the points. REQUIRES: pairs with points
std::vector<Rigid3> poses_of(std::span<const FocalPair> pairs, const Eigen::VectorXd& log_focals,
                             const FocalRefinementOptions& options);

/// Focal lengths and relative poses that minimise the robust Sampson errors of all pairs:
/// Levenberg-Marquardt with the poses eliminated (Schur complement). A pair's cost c enters as c /
/// (1 + c / limit) (Geman & McClure), limit being pair_loss a point: wrong pairs let go. REQUIRES:
/// pairs with points; sizes agree. Deterministic. Thread-safe.
FocalEstimate refine_focals(std::span<const FocalPair> pairs, FocalEstimate start,
                            const FocalExpectation& expectation,
                            const FocalRefinementOptions& options);

}  // namespace psfm
