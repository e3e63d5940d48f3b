// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "stages/algorithms/two_view/refine_two_view.h"
#include "stages/algorithms/two_view/sampson.h"

namespace psfm {

/// A model with the correspondences that agree with it.
struct RobustModel {
    Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
    std::vector<std::uint32_t> inliers;  ///< ascending indices into the points
};

struct RobustOptions {
    double max_error_px = 4.0;   ///< see VerifyOptions::max_error_px
    double confidence = 0.999;   ///< see VerifyOptions::confidence
    int max_iterations = 10000;  ///< see VerifyOptions::max_iterations
};

/// Robust estimates by OpenCV's USAC (MSAC score, inner and iterated local optimisation). Points
/// are undistorted pixels of pinhole cameras. Nothing when there are too few points (E 5, F 7, H 4)
/// or no model was found; the inliers are those of USAC at max_error_px. Equal inputs and seed give
/// equal results, on any number of threads. Thread-safe.
std::optional<RobustModel> estimate_essential(std::span<const PointPair> points,
                                              const IntrinsicPair& intrinsics,
                                              const RobustOptions& options, std::uint64_t seed);
std::optional<RobustModel> estimate_fundamental(std::span<const PointPair> points,
                                                const RobustOptions& options, std::uint64_t seed);
std::optional<RobustModel> estimate_homography(std::span<const PointPair> points,
                                               const RobustOptions& options, std::uint64_t seed);

}  // namespace psfm
