// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/averaging/chordal_positions.h"

#include <ceres/autodiff_cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/manifold.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <deque>

#include "stages/algorithms/math/angles.h"

namespace psfm {
namespace {

/// Guard: squared lengths [smallest length of the start] below which a direction is not defined.
constexpr double kMinSquaredLength = 1e-16;

/// Guard: length, in parts of the mean, up to which ends coincide: their direction would be noise.
constexpr double kCoinciding = 1e-6;
/// Guard: by what part of it they are moved apart: far enough to have a direction, too little to
/// matter where they do not belong apart. Ours; not tuned.
constexpr double kMovedApart = 0.01;

struct ChordCost {
    Eigen::Vector3d direction;

    template <typename T>
    bool operator()(const T* const i, const T* const j, T* residual) const {
        using Vector = Eigen::Matrix<T, 3, 1>;
        const Vector difference = Eigen::Map<const Vector>(j) - Eigen::Map<const Vector>(i);
        const T square = difference.squaredNorm();
        if (square < T(kMinSquaredLength)) return false;
        using std::sqrt;
        Eigen::Map<Vector>{residual} = difference / sqrt(square) - direction.cast<T>();
        return true;
    }
};

/// Ends that coincide are moved apart by a part of the mean length, along the measurement.
void part_coinciding_ends(const std::vector<RelativeDirection>& edges, Columns3& positions) {
    double mean = 0.0;
    for (const RelativeDirection& edge : edges) {
        mean += (positions.col(edge.j) - positions.col(edge.i)).norm();
    }
    mean /= static_cast<double>(edges.size());
    for (const RelativeDirection& edge : edges) {
        if ((positions.col(edge.j) - positions.col(edge.i)).norm() > kCoinciding * mean) continue;
        positions.col(edge.j) += kMovedApart * mean * edge.direction;
    }
}

}  // namespace

double chord(const RelativeDirection& edge, const Columns3& positions) {
    const Eigen::Vector3d difference = positions.col(edge.j) - positions.col(edge.i);
    const double length = difference.norm();
    if (!(length * length > kMinSquaredLength)) return 1.0;
    return (difference / length - edge.direction).norm();
}

Result<Columns3> refine_positions(const std::vector<RelativeDirection>& edges, Columns3 positions,
                                  const PositionAveragingOptions& options) {
    part_coinciding_ends(edges, positions);
    const double width = radians_from_degrees(options.loss_scale_deg);
    ceres::HuberLoss huber(width);
    std::deque<ceres::ScaledLoss> losses;
    ceres::Problem::Options ownership;
    ownership.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    ownership.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    ceres::Problem problem(ownership);
    // All blocks in one array: bitwise repeatable (docs/parts.md).
    const auto block = [&](std::uint32_t node) { return positions.col(node).data(); };
    for (std::uint32_t node = 0; node < positions.cols(); ++node) {
        problem.AddParameterBlock(block(node), 3);
    }
    for (const RelativeDirection& edge : edges) {
        losses.emplace_back(&huber, edge.weight, ceres::DO_NOT_TAKE_OWNERSHIP);
        problem.AddResidualBlock(
            new ceres::AutoDiffCostFunction<ChordCost, 3, 3, 3>(new ChordCost{edge.direction}),
            &losses.back(), block(edge.i), block(edge.j));
    }
    problem.SetParameterBlockConstant(block(0));
    Eigen::Index farthest = 0;
    (positions.colwise() - Eigen::Vector3d(positions.col(0)))
        .colwise()
        .squaredNorm()
        .maxCoeff(&farthest);
    int coordinate = 0;
    (positions.col(farthest) - positions.col(0)).cwiseAbs().maxCoeff(&coordinate);
    ceres::SubsetManifold scale_fixed(3, {coordinate});
    if (farthest != 0) problem.SetManifold(positions.col(farthest).data(), &scale_fixed);

    ceres::Solver::Options solver;
    // Most nodes are points, which have directions to images only: Ceres finds and eliminates them.
    solver.linear_solver_type = ceres::SPARSE_SCHUR;
    // EIGEN_SPARSE does not depend on OpenBLAS's threads and core type (docs/parts.md).
    solver.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
    solver.max_num_iterations = options.max_refinement_iterations;
    solver.num_threads = 1;
    solver.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &problem, &summary);
    if (!summary.IsSolutionUsable()) {
        return Error{ErrorCode::kDegenerate,
                     "position averaging found no solution: " + summary.message};
    }
    return positions;
}

}  // namespace psfm
