// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/evaluation/fit_similarity.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "stages/algorithms/math/decompositions.h"

namespace psfm {
namespace {

/// Guard: below this ratio of the spreads across and along, points count as lying on a line:
/// rounding of coordinates in double precision stays far below it, and every real baseline far
/// above.
constexpr double kCollinearRatio = 1e-10;

Eigen::Vector3d mean_of(std::span<const Eigen::Vector3d> points) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& point : points) sum += point;
    return sum / static_cast<double>(points.size());
}

}  // namespace

Result<SimilarityFit> fit_similarity(std::span<const Eigen::Vector3d> source,
                                     std::span<const Eigen::Vector3d> target) {
    if (source.size() != target.size() || source.size() < 2) {
        return Error{ErrorCode::kTooFewMatches, "a similarity needs two points on each side"};
    }
    const Eigen::Vector3d source_mean = mean_of(source);
    const Eigen::Vector3d target_mean = mean_of(target);
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // of target and source
    double source_variance = 0.0;
    double target_variance = 0.0;
    for (std::size_t i = 0; i < source.size(); ++i) {
        const Eigen::Vector3d from = source[i] - source_mean;
        const Eigen::Vector3d to = target[i] - target_mean;
        covariance += to * from.transpose();
        source_variance += from.squaredNorm();
        target_variance += to.squaredNorm();
    }
    // Guard: rounding leaves coinciding points a spread of about 1e-16 of their distance from the
    // origin.
    constexpr double kRounding = 1e-28;
    const auto count = static_cast<double>(source.size());
    if (source_variance <= kRounding * count * source_mean.squaredNorm() ||
        target_variance <= kRounding * count * target_mean.squaredNorm()) {
        return Error{ErrorCode::kDegenerate, "the points of one side coincide"};
    }
    const SingularValues svd = singular_values(covariance);
    Eigen::Vector3d sign = Eigen::Vector3d::Ones();
    if (svd.u.determinant() * svd.v.determinant() < 0.0) sign.z() = -1.0;
    const Eigen::Matrix3d rotation = svd.u * sign.asDiagonal() * svd.v.transpose();
    const double scale = svd.values.dot(sign) / source_variance;
    if (!std::isfinite(scale) || scale <= 0.0) {
        return Error{ErrorCode::kDegenerate, "no similarity of positive scale fits the points"};
    }
    SimilarityFit fit;
    fit.target_from_source.scale = scale;
    fit.target_from_source.rotation = Eigen::Quaterniond(rotation).normalized();
    fit.target_from_source.translation =
        target_mean - scale * (fit.target_from_source.rotation * source_mean);
    fit.collinear = svd.values(1) < kCollinearRatio * svd.values(0);
    return fit;
}

}  // namespace psfm
