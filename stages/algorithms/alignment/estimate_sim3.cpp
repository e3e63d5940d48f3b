// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/alignment/estimate_sim3.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "stages/algorithms/math/decompositions.h"

namespace psfm {

Result<Sim3> estimate_sim3(std::span<const Eigen::Vector3d> source,
                           std::span<const Eigen::Vector3d> target,
                           std::span<const double> weights) {
    if (source.size() != target.size() || (!weights.empty() && weights.size() != source.size())) {
        return Error{ErrorCode::kInvalidArgument,
                     "similarity: the lists of points differ in length"};
    }
    const auto weight_of = [&](std::size_t k) { return weights.empty() ? 1.0 : weights[k]; };
    double total = 0.0;
    std::size_t used = 0;
    Eigen::Vector3d source_mean = Eigen::Vector3d::Zero();
    Eigen::Vector3d target_mean = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < source.size(); ++k) {
        const double weight = weight_of(k);
        if (!(weight >= 0.0) || !std::isfinite(weight) || !source[k].allFinite() ||
            !target[k].allFinite()) {
            return Error{ErrorCode::kInvalidArgument,
                         "similarity: points and weights must be finite, "
                         "weights not negative"};
        }
        total += weight;
        used += weight > 0.0 ? 1 : 0;
        source_mean += weight * source[k];
        target_mean += weight * target[k];
    }
    if (used < 3) return Error{ErrorCode::kDegenerate, "similarity: needs three points"};
    source_mean /= total;
    target_mean /= total;

    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    double source_variance = 0.0;
    for (std::size_t k = 0; k < source.size(); ++k) {
        const Eigen::Vector3d from_mean = source[k] - source_mean;
        covariance += weight_of(k) * (target[k] - target_mean) * from_mean.transpose();
        source_variance += weight_of(k) * from_mean.squaredNorm();
    }
    const SingularValues svd = singular_values(covariance);
    const Eigen::Vector3d& values = svd.values;
    // Guard: the second value vanishes when either side is a line or a point.
    constexpr double kLine = 1e-10;
    if (!(values[1] > kLine * values[0])) {
        return Error{ErrorCode::kDegenerate, "similarity: the points lie on one line"};
    }
    Eigen::Vector3d signs = Eigen::Vector3d::Ones();
    if (svd.u.determinant() * svd.v.determinant() < 0.0) signs[2] = -1.0;
    const Eigen::Matrix3d rotation = svd.u * signs.asDiagonal() * svd.v.transpose();
    Sim3 target_from_source;
    target_from_source.rotation = Eigen::Quaterniond(rotation).normalized();
    target_from_source.scale = values.dot(signs) / source_variance;
    if (!(target_from_source.scale > 0.0) || !std::isfinite(target_from_source.scale)) {
        return Error{ErrorCode::kDegenerate, "similarity: the points give no scale"};
    }
    target_from_source.translation =
        target_mean - target_from_source.scale * (target_from_source.rotation * source_mean);
    return target_from_source;
}

}  // namespace psfm
