// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/focal/refine_focals.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "stages/algorithms/math/decompositions.h"
#include "stages/algorithms/two_view/decompose_two_view.h"
#include "stages/algorithms/two_view/refine_two_view.h"

namespace psfm {
namespace {

using Vector5d = Eigen::Matrix<double, 5, 1>;
using Matrix5d = Eigen::Matrix<double, 5, 5>;
using Matrix52d = Eigen::Matrix<double, 5, 2>;
using Matrix7d = Eigen::Matrix<double, 7, 7>;
using Vector7d = Eigen::Matrix<double, 7, 1>;

/// Guard: a step changes no logarithm of a focal length by more than this: further off, the
/// linearisation is void.
constexpr double kLargestStep = 0.3;
constexpr double kFocalCostTolerance = 1e-6;  // Guard: ends the loop

/// What turns a step of the focal lengths into a step of a pair's pose.
struct PoseStep {
    Vector5d alone = Vector5d::Zero();
    Matrix52d by_focals = Matrix52d::Zero();
};

struct FocalSystem {
    double cost = 0.0;
    Eigen::MatrixXd information;  ///< of the logarithms of the focal lengths
    Eigen::VectorXd gradient;
    std::vector<PoseStep> steps;
};

IntrinsicPair intrinsics_of(const FocalPair& pair, const Eigen::VectorXd& log_focals) {
    return {pair.end1.intrinsic(log_focals), pair.end2.intrinsic(log_focals)};
}

/// c / (1 + c / limit) and its derivative.
struct PairLoss {
    double cost = 0.0;
    double weight = 1.0;
};
PairLoss pair_loss(double cost, std::size_t points, double limit_per_point) {
    const double share = 1.0 + cost / (limit_per_point * static_cast<double>(points));
    return {cost / share, 1.0 / (share * share)};
}

double expectation_cost(const Eigen::VectorXd& log_focals, const FocalExpectation& expectation) {
    return 0.5 * (log_focals - expectation.log_focals).squaredNorm() /
           (expectation.deviation * expectation.deviation);
}

/// d vec(F) / d (pose, log focal 1, log focal 2), for points relative to the principal points.
Eigen::Matrix<double, 9, 7> jacobian_of(const Rigid3& pose, const IntrinsicPair& intrinsics,
                                        const Eigen::Matrix3d& f) {
    const Eigen::Matrix3d shrink = Eigen::Vector3d(-1, -1, 0).asDiagonal();
    const Eigen::Matrix3d by_first = f * shrink;
    const Eigen::Matrix3d by_second = shrink * f;
    Eigen::Matrix<double, 9, 7> jacobian;
    jacobian.leftCols<5>() = pose_jacobian(pose, intrinsics);
    jacobian.col(5) = Eigen::Map<const Vector9d>(by_first.data());
    jacobian.col(6) = Eigen::Map<const Vector9d>(by_second.data());
    return jacobian;
}

double total_cost(std::span<const FocalPair> pairs, const FocalEstimate& estimate,
                  const FocalExpectation& expectation, const FocalRefinementOptions& options) {
    double cost = expectation_cost(estimate.log_focals, expectation);
    const double unit_cost = options.loss_scale * options.loss_scale;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const Eigen::Matrix3d f =
            fundamental_from_pose(estimate.poses[i], intrinsics_of(pairs[i], estimate.log_focals));
        const double pair_cost = sampson_cost(pairs[i].points, f, options.loss_scale) / unit_cost;
        cost += pair_loss(pair_cost, pairs[i].points.size(), options.pair_loss).cost;
    }
    return cost;
}

FocalSystem linearize(std::span<const FocalPair> pairs, const FocalEstimate& estimate,
                      const FocalExpectation& expectation, const FocalRefinementOptions& options,
                      double damping) {
    const Eigen::Index count = estimate.log_focals.size();
    const double unit_cost = options.loss_scale * options.loss_scale;
    FocalSystem system;
    system.cost = expectation_cost(estimate.log_focals, expectation);
    system.information = Eigen::MatrixXd::Zero(count, count);
    system.gradient = Eigen::VectorXd::Zero(count);
    system.steps.resize(pairs.size());
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const FocalPair& pair = pairs[i];
        const IntrinsicPair intrinsics = intrinsics_of(pair, estimate.log_focals);
        const Eigen::Matrix3d f = fundamental_from_pose(estimate.poses[i], intrinsics);
        const SampsonSystem sampson = linearize_sampson(pair.points, f, options.loss_scale);
        const PairLoss loss =
            pair_loss(sampson.cost / unit_cost, pair.points.size(), options.pair_loss);
        system.cost += loss.cost;

        const Eigen::Matrix<double, 9, 7> jacobian = jacobian_of(estimate.poses[i], intrinsics, f);
        const double weight = loss.weight / unit_cost;
        const Matrix7d normal = weight * (jacobian.transpose() * sampson.information * jacobian);
        const Vector7d gradient = weight * (jacobian.transpose() * sampson.gradient);
        Matrix5d pose_block = normal.topLeftCorner<5, 5>();
        pose_block.diagonal() += damping * pose_block.diagonal() +
                                 Vector5d::Constant(1e-9 * pose_block.trace() + 1e-300);
        const Matrix52d cross = normal.topRightCorner<5, 2>();
        PoseStep& step = system.steps[i];
        Eigen::Matrix<double, 5, 3> right;
        right << gradient.head<5>(), cross;
        const SmallMatrix solved = solve_symmetric(pose_block, right);
        step.alone = -solved.col(0);
        step.by_focals = -solved.rightCols<2>();
        const Eigen::Matrix2d reduced =
            normal.bottomRightCorner<2, 2>() + cross.transpose() * step.by_focals;
        const Eigen::Vector2d reduced_gradient =
            gradient.tail<2>() + cross.transpose() * step.alone;
        const std::array<std::optional<std::size_t>, 2> parameters{pair.end1.parameter,
                                                                   pair.end2.parameter};
        for (std::size_t a = 0; a < 2; ++a) {
            if (!parameters[a]) continue;
            const auto row = static_cast<Eigen::Index>(*parameters[a]);
            system.gradient[row] += reduced_gradient[static_cast<Eigen::Index>(a)];
            for (std::size_t b = 0; b < 2; ++b) {
                if (!parameters[b]) continue;
                system.information(row, static_cast<Eigen::Index>(*parameters[b])) +=
                    reduced(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b));
            }
        }
    }
    const double expected = 1.0 / (expectation.deviation * expectation.deviation);
    system.information.diagonal().array() += expected;
    system.gradient += expected * (estimate.log_focals - expectation.log_focals);
    return system;
}

FocalEstimate moved(std::span<const FocalPair> pairs, const FocalEstimate& estimate,
                    const FocalSystem& system, const Eigen::VectorXd& step) {
    const auto step_of = [&](const FocalEnd& end) {
        return end.parameter ? step[static_cast<Eigen::Index>(*end.parameter)] : 0.0;
    };
    FocalEstimate next = estimate;
    next.log_focals += step;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const Eigen::Vector2d focal_step(step_of(pairs[i].end1), step_of(pairs[i].end2));
        const Vector5d pose_step = system.steps[i].alone + system.steps[i].by_focals * focal_step;
        if (pose_step.allFinite()) next.poses[i] = moved_pose(estimate.poses[i], pose_step);
    }
    return next;
}

}  // namespace

std::vector<Rigid3> poses_of(std::span<const FocalPair> pairs, const Eigen::VectorXd& log_focals,
                             const FocalRefinementOptions& options) {
    std::vector<Rigid3> poses;
    poses.reserve(pairs.size());
    RefineOptions refine;
    refine.loss_scale = options.loss_scale;
    for (const FocalPair& pair : pairs) {
        const IntrinsicPair k = intrinsics_of(pair, log_focals);
        std::vector<PointPair> normalized = pair.points;
        for (PointPair& p : normalized) {
            p = {{p.x1.x() / k.k1(0, 0), p.x1.y() / k.k1(1, 1)},
                 {p.x2.x() / k.k2(0, 0), p.x2.y() / k.k2(1, 1)}};
        }
        const std::vector<Rigid3> candidates = poses_from_essential(k.k2 * pair.fundamental * k.k1);
        const Rigid3 start = choose_by_cheirality(candidates, normalized).cam2_from_cam1;
        poses.push_back(refine_relative_pose(pair.points, k, start, refine));
    }
    return poses;
}

FocalEstimate refine_focals(std::span<const FocalPair> pairs, FocalEstimate start,
                            const FocalExpectation& expectation,
                            const FocalRefinementOptions& options) {
    FocalEstimate estimate = std::move(start);
    constexpr double kMostDamping = 1e5;    // Guard: ends the loop: steps of no length
    constexpr double kLeastDamping = 1e-7;  // Guard: keeps a step that went wrong from costing many
    double damping = 1e-3;
    for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
        const FocalSystem system = linearize(pairs, estimate, expectation, options, damping);
        Eigen::MatrixXd damped = system.information;
        damped.diagonal() *= 1.0 + damping;
        const Eigen::VectorXd step = (-solve_large_symmetric(damped, system.gradient))
                                         .cwiseMin(kLargestStep)
                                         .cwiseMax(-kLargestStep);
        if (!step.allFinite()) break;
        FocalEstimate next = moved(pairs, estimate, system, step);
        const double cost = total_cost(pairs, next, expectation, options);
        if (!(cost < system.cost)) {
            damping *= 10.0;
            if (damping > kMostDamping) break;
            continue;
        }
        estimate = std::move(next);
        damping = std::max(0.1 * damping, kLeastDamping);
        if (system.cost - cost < kFocalCostTolerance * system.cost) break;
    }
    const FocalSystem system = linearize(pairs, estimate, expectation, options, 0.0);
    const Eigen::Index count = estimate.log_focals.size();
    const Eigen::MatrixXd covariance =
        solve_large_symmetric(system.information, Eigen::MatrixXd::Identity(count, count));
    estimate.uncertainty = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
    return estimate;
}

}  // namespace psfm
