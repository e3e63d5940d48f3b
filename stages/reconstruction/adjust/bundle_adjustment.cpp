// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/adjust/bundle_adjustment.h"

#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <cmath>
#include <deque>

#include "stages/algorithms/adjustment/reprojection_cost.h"
#include "stages/reconstruction/adjust/adjustment_problem.h"
#include "stages/reconstruction/adjust/reduced_adjustment.h"

namespace psfm {
namespace {

/// The solver takes the parameters to the least cost that it finds.
Result<AdjustmentCosts> adjust_with_ceres(const WorkingModel& model, const AdjustmentScope& scope,
                                          const AdjustmentSelection& selection,
                                          const AdjustmentOptions& options,
                                          AdjustmentParameters& parameters) {
    ceres::Problem::Options problem_options;
    problem_options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    problem_options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    problem_options.disable_all_safety_checks = true;
    ceres::SoftLOneLoss loss(options.loss_scale_px);
    PoseManifold pose_manifold;
    PoseManifold scale_manifold(scope.gauge ? scale_coordinate(model, *scope.gauge) : 0);
    std::vector<std::unique_ptr<ceres::Manifold>> manifolds;
    std::deque<PrincipalPointPrior> priors;
    std::deque<ReprojectionCost> costs;  // a deque: the problem keeps pointers into it
    ceres::Problem problem(problem_options);
    for (const AdjustmentResidual& residual : selection.residuals) {
        const std::uint32_t image = residual.feature.image;
        costs.emplace_back(model.camera(image).model,
                           model.pixel(residual.feature) +
                               shift_to_block(model, parameters, model.camera_id(image)),
                           observation_sigma(model.keypoint(residual.feature), options));
        problem.AddResidualBlock(
            &costs.back(), &loss, &parameters.values[parameters.pose_at[image]],
            &parameters.values[parameters.point_at[residual.point]],
            &parameters.values[parameters.camera_at.at(model.camera_id(image))]);
    }

    auto* ordering = new ceres::ParameterBlockOrdering;
    for (std::uint32_t image = 0; image < model.image_count(); ++image) {
        if (parameters.pose_at[image] == AdjustmentParameters::kAbsent) continue;
        double* block = &parameters.values[parameters.pose_at[image]];
        const bool is_origin = scope.gauge && scope.gauge->origin == image;
        if (!selection.image_is_free[image] || is_origin) {
            problem.SetParameterBlockConstant(block);
        } else {
            const bool keeps_scale = scope.gauge && scope.gauge->farthest == image;
            problem.SetManifold(block, keeps_scale ? &scale_manifold : &pose_manifold);
        }
        ordering->AddElementToGroup(block, 1);
    }
    for (std::uint32_t point = 0; point < model.points().size(); ++point) {
        if (parameters.point_at[point] == AdjustmentParameters::kAbsent) continue;
        double* block = &parameters.values[parameters.point_at[point]];
        if (!selection.point_is_free[point]) problem.SetParameterBlockConstant(block);
        ordering->AddElementToGroup(block, 0);
    }
    for (const auto& [camera, at] : parameters.camera_at) {
        if (parameters.owner_of(camera) != camera) continue;
        double* block = &parameters.values[at];
        if (block_is_free(parameters, scope, camera)) {
            const bool free_point = std::ranges::binary_search(scope.free_principal_points, camera);
            const Camera& initial = model.cameras().at(camera);
            manifolds.push_back(std::make_unique<ceres::SubsetManifold>(
                kIntrinsicsSize, held_intrinsics(model, scope, camera)));
            if (free_point) {
                priors.emplace_back(initial, options.principal_point_sigma *
                                                 std::max(initial.width, initial.height));
                problem.AddResidualBlock(&priors.back(), nullptr, block);
            }
            problem.SetManifold(block, manifolds.back().get());
        } else {
            problem.SetParameterBlockConstant(block);
        }
        ordering->AddElementToGroup(block, 1);
    }

    ceres::Solver::Options solver;
    solver.linear_solver_ordering.reset(ordering);
    solver.linear_solver_type = ceres::SPARSE_SCHUR;
    // EIGEN_SPARSE does not depend on OpenBLAS's threads and core type (docs/parts.md).
    solver.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
    solver.max_num_iterations = options.max_iterations;
    solver.function_tolerance = options.function_tolerance;
    solver.gradient_tolerance = 1e-10;
    solver.parameter_tolerance = 1e-8;
    solver.num_threads = 1;
    solver.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &problem, &summary);
    if (!summary.IsSolutionUsable()) {
        return Error{ErrorCode::kDegenerate,
                     "bundle adjustment found no solution: " + summary.message};
    }
    return AdjustmentCosts{summary.initial_cost, summary.final_cost,
                           static_cast<int>(summary.iterations.size())};
}

}  // namespace

double observation_sigma(const Keypoint& keypoint, const AdjustmentOptions& options) {
    return std::max(1.0, options.sigma_per_scale * keypoint.scale);
}

Result<AdjustmentReport> adjust(WorkingModel& model, const AdjustmentScope& scope,
                                const AdjustmentOptions& options, const std::atomic<bool>* cancel) {
    AdjustmentSelection selection = select_residuals(model, scope);
    if (selection.residuals.empty())
        return Error{ErrorCode::kDegenerate, "bundle adjustment: no observations"};
    AdjustmentParameters parameters = lay_out(model, selection.residuals);
    const AdjustmentColumns columns = make_columns(model, scope, selection, parameters);
    order_by_column(selection, columns);
    const TilePattern pattern = pattern_of(columns, selection, model);
    const bool reduce = columns.count > 0 && pattern.bytes() <= std::size_t{options.max_reduced_mib}
                                                                    << 20U;
    const auto costs =
        reduce ? adjust_reduced(model, selection, columns, pattern, options, parameters, cancel)
               : adjust_with_ceres(model, scope, selection, options, parameters);
    if (!costs.ok()) return costs.error();
    if (const auto senseless = senseless_cameras(parameters, scope, model); !senseless.empty()) {
        AdjustmentScope rest = scope;
        std::erase_if(rest.free_cameras, [&](CameraId camera) {
            return std::ranges::binary_search(senseless, camera);
        });
        return adjust(model, rest, options, cancel);
    }
    write_back(parameters, selection, scope, model);
    AdjustmentReport report;
    report.residuals = selection.residuals.size();
    report.iterations = costs->iterations;
    const auto rms = [&](double cost) {
        return std::sqrt(2.0 * cost / static_cast<double>(report.residuals));
    };
    report.rms_before_px = rms(costs->before);
    report.rms_after_px = rms(costs->after);
    return report;
}

}  // namespace psfm
