// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/bundle_adjustment.h"

#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>

#include "stages/reconstruction/reprojection_cost.h"

namespace psfm {
namespace {

/// Parameters of one adjustment in one array: cameras first, then poses, then points.
struct Parameters {
    std::vector<double> values;
    std::map<CameraId, std::size_t> camera_at;
    std::vector<std::size_t> pose_at;   // per image; kAbsent when it takes no part
    std::vector<std::size_t> point_at;  // per point; kAbsent when it takes no part
    static constexpr std::size_t kAbsent = static_cast<std::size_t>(-1);
};

struct Residual {
    WorkingModel::Feature feature;
    std::uint32_t point;
};

struct Selection {
    std::vector<Residual> residuals;
    std::vector<bool> point_is_free;
    std::vector<bool> image_is_free;
};

Selection select_residuals(const WorkingModel& model, const AdjustmentScope& scope) {
    Selection selection;
    selection.point_is_free.assign(model.points().size(), false);
    selection.image_is_free.assign(model.image_count(), false);
    for (const std::uint32_t image : scope.free_images) selection.image_is_free[image] = true;
    std::vector<bool> takes_part(model.points().size(), !scope.points);
    if (scope.points) {
        for (const std::uint32_t point : *scope.points) takes_part[point] = true;
    }
    const auto visit_points = [&](std::uint32_t image, auto&& visit) {
        for (std::uint32_t feature = 0; feature < model.matches().feature_count(image); ++feature) {
            const std::uint32_t point = model.point_of({image, feature});
            if (point != WorkingModel::kNoPoint && takes_part[point])
                visit(WorkingModel::Feature{image, feature}, point);
        }
    };
    for (const std::uint32_t image : scope.point_images) {
        visit_points(image, [&](const auto&, std::uint32_t point) {
            selection.point_is_free[point] = true;
        });
    }
    const auto add = [&](const WorkingModel::Feature& feature, std::uint32_t point) {
        // A point behind a camera has no residual to start from; filtering will remove it.
        if ((model.pose(feature.image) * model.points()[point].position).z() > 1e-6) {
            selection.residuals.push_back({feature, point});
        }
    };
    for (std::uint32_t point = 0; point < selection.point_is_free.size(); ++point) {
        if (!selection.point_is_free[point]) continue;
        for (const WorkingModel::Feature& feature : model.points()[point].track)
            add(feature, point);
    }
    for (const std::uint32_t image : scope.free_images) {
        visit_points(image, [&](const WorkingModel::Feature& feature, std::uint32_t point) {
            if (!selection.point_is_free[point]) add(feature, point);
        });
    }
    return selection;
}

Parameters lay_out(const WorkingModel& model, const std::vector<Residual>& residuals) {
    Parameters parameters;
    parameters.pose_at.assign(model.image_count(), Parameters::kAbsent);
    parameters.point_at.assign(model.points().size(), Parameters::kAbsent);
    for (const Residual& residual : residuals) {
        parameters.pose_at[residual.feature.image] = 0;
        parameters.point_at[residual.point] = 0;
        parameters.camera_at[model.camera_id(residual.feature.image)] = 0;
    }
    std::size_t size = 0;
    const auto place = [&](std::size_t& at, std::size_t block) {
        if (at == Parameters::kAbsent) return;
        at = size;
        size += block;
    };
    for (auto& [camera, at] : parameters.camera_at) place(at, kIntrinsicsSize);
    for (std::size_t& at : parameters.pose_at) place(at, kPoseSize);
    for (std::size_t& at : parameters.point_at) place(at, kPointSize);
    parameters.values.resize(size);
    for (const auto& [camera, at] : parameters.camera_at) {
        std::ranges::copy(model.cameras().at(camera).params,
                          parameters.values.begin() + static_cast<std::ptrdiff_t>(at));
    }
    for (std::uint32_t image = 0; image < parameters.pose_at.size(); ++image) {
        if (parameters.pose_at[image] != Parameters::kAbsent) {
            write_pose(model.pose(image), &parameters.values[parameters.pose_at[image]]);
        }
    }
    for (std::uint32_t point = 0; point < parameters.point_at.size(); ++point) {
        if (parameters.point_at[point] != Parameters::kAbsent) {
            Eigen::Map<Eigen::Vector3d>{&parameters.values[parameters.point_at[point]]} =
                model.points()[point].position;
        }
    }
    return parameters;
}

/// Unused slots stay fixed, and the principal point (the first two of each list) unless it is free.
ceres::SubsetManifold* intrinsics_manifold(CameraModel model, bool free_principal_point) {
    std::vector<int> constant;
    switch (model) {
        case CameraModel::kSimplePinhole:
            constant = {1, 2, 3, 4, 5, 6, 7};
            break;
        case CameraModel::kSimpleRadial:
            constant = {1, 2, 4, 5, 6, 7};
            break;
        case CameraModel::kRadial:
            constant = {1, 2, 5, 6, 7};
            break;
        case CameraModel::kPinhole:
            constant = {2, 3, 4, 5, 6, 7};
            break;
        case CameraModel::kOpenCv:
            constant = {2, 3};
            break;
    }
    if (free_principal_point) constant.erase(constant.begin(), constant.begin() + 2);
    return new ceres::SubsetManifold(kIntrinsicsSize, constant);
}

/// The coordinate of the farthest image's translation that changes most when the scene is scaled
/// about the origin.
int scale_coordinate(const WorkingModel& model, const AdjustmentScope::Gauge& gauge) {
    const Eigen::Vector3d offset = model.centre(gauge.farthest) - model.centre(gauge.origin);
    const Eigen::Vector3d change = model.pose(gauge.farthest).rotation * offset;
    int coordinate = 0;
    change.cwiseAbs().maxCoeff(&coordinate);
    return coordinate;
}

void write_back(const Parameters& parameters, const Selection& selection,
                const AdjustmentScope& scope, WorkingModel& model) {
    for (const std::uint32_t image : scope.free_images) {
        const std::size_t at = parameters.pose_at[image];
        if (at != Parameters::kAbsent) model.set_pose(image, read_pose(&parameters.values[at]));
    }
    for (std::uint32_t point = 0; point < parameters.point_at.size(); ++point) {
        const std::size_t at = parameters.point_at[point];
        if (at == Parameters::kAbsent || !selection.point_is_free[point]) continue;
        model.set_position(point, Eigen::Map<const Eigen::Vector3d>(&parameters.values[at]));
    }
    for (const CameraId camera : scope.free_cameras) {
        const auto at = parameters.camera_at.find(camera);
        if (at == parameters.camera_at.end()) continue;
        Camera refined = model.cameras().at(camera);
        std::copy_n(parameters.values.begin() + static_cast<std::ptrdiff_t>(at->second),
                    kIntrinsicsSize, refined.params.begin());
        if (!validate(refined).ok()) continue;
        if (refined.focal_source != FocalSource::kGiven)
            refined.focal_source = FocalSource::kEstimated;
        model.mutable_camera(camera) = refined;
    }
}

}  // namespace

Result<void> validate(const AdjustmentOptions& options) {
    if (!(options.loss_scale_px > 0) || options.max_iterations < 1 ||
        !(options.function_tolerance > 0) || !(options.sigma_per_scale >= 0) ||
        !(options.principal_point_sigma > 0)) {
        return Error{ErrorCode::kInvalidArgument,
                     "bundle adjustment: scales, iterations and tolerance must be positive"};
    }
    return {};
}

double observation_sigma(const Keypoint& keypoint, const AdjustmentOptions& options) {
    return std::max(1.0, options.sigma_per_scale * keypoint.scale);
}

Result<AdjustmentReport> adjust(WorkingModel& model, const AdjustmentScope& scope,
                                const AdjustmentOptions& options) {
    const Selection selection = select_residuals(model, scope);
    if (selection.residuals.empty())
        return Error{ErrorCode::kDegenerate, "bundle adjustment: no observations"};
    Parameters parameters = lay_out(model, selection.residuals);

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
    for (const Residual& residual : selection.residuals) {
        const std::uint32_t image = residual.feature.image;
        costs.emplace_back(model.camera(image).model, model.pixel(residual.feature),
                           observation_sigma(model.keypoint(residual.feature), options));
        problem.AddResidualBlock(
            &costs.back(), &loss, &parameters.values[parameters.pose_at[image]],
            &parameters.values[parameters.point_at[residual.point]],
            &parameters.values[parameters.camera_at.at(model.camera_id(image))]);
    }

    auto* ordering = new ceres::ParameterBlockOrdering;
    std::size_t free_poses = 0;
    for (std::uint32_t image = 0; image < model.image_count(); ++image) {
        if (parameters.pose_at[image] == Parameters::kAbsent) continue;
        double* block = &parameters.values[parameters.pose_at[image]];
        const bool is_origin = scope.gauge && scope.gauge->origin == image;
        if (!selection.image_is_free[image] || is_origin) {
            problem.SetParameterBlockConstant(block);
        } else {
            const bool keeps_scale = scope.gauge && scope.gauge->farthest == image;
            problem.SetManifold(block, keeps_scale ? &scale_manifold : &pose_manifold);
            ++free_poses;
        }
        ordering->AddElementToGroup(block, 1);
    }
    for (std::uint32_t point = 0; point < model.points().size(); ++point) {
        if (parameters.point_at[point] == Parameters::kAbsent) continue;
        double* block = &parameters.values[parameters.point_at[point]];
        if (!selection.point_is_free[point]) problem.SetParameterBlockConstant(block);
        ordering->AddElementToGroup(block, 0);
    }
    for (const auto& [camera, at] : parameters.camera_at) {
        double* block = &parameters.values[at];
        if (std::ranges::binary_search(scope.free_cameras, camera)) {
            const bool free_point = std::ranges::binary_search(scope.free_principal_points, camera);
            const Camera& initial = model.cameras().at(camera);
            manifolds.emplace_back(intrinsics_manifold(initial.model, free_point));
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
    solver.linear_solver_type =
        free_poses <= options.dense_up_to_images ? ceres::DENSE_SCHUR : ceres::SPARSE_SCHUR;
    // EIGEN_SPARSE does not depend on OpenBLAS's threads and core type (PARTS.md).
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
    write_back(parameters, selection, scope, model);
    AdjustmentReport report;
    report.residuals = selection.residuals.size();
    report.iterations = static_cast<int>(summary.iterations.size());
    const auto rms = [&](double cost) {
        return std::sqrt(2.0 * cost / static_cast<double>(report.residuals));
    };
    report.rms_before_px = rms(summary.initial_cost);
    report.rms_after_px = rms(summary.final_cost);
    return report;
}

}  // namespace psfm
