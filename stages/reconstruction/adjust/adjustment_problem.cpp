// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/adjust/adjustment_problem.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "stages/algorithms/adjustment/reprojection.h"

namespace psfm {

AdjustmentSelection select_residuals(const WorkingModel& model, const AdjustmentScope& scope) {
    AdjustmentSelection selection;
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
            selection.point_is_free[point] =
                scope.longest_moving_track == 0 ||
                model.points()[point].track.size() <= scope.longest_moving_track;
        });
    }
    const auto add = [&](const WorkingModel::Feature& feature, std::uint32_t point) {
        // A point behind a camera has no residual to start from; filtering will remove it.
        constexpr double kNearest = 1e-6;  // Guard: of a depth that is divided by
        if ((model.pose(feature.image) * model.points()[point].position).z() > kNearest) {
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

AdjustmentParameters lay_out(const WorkingModel& model,
                             const std::vector<AdjustmentResidual>& residuals) {
    AdjustmentParameters parameters;
    parameters.pose_at.assign(model.image_count(), AdjustmentParameters::kAbsent);
    parameters.point_at.assign(model.points().size(), AdjustmentParameters::kAbsent);
    for (const AdjustmentResidual& residual : residuals) {
        parameters.pose_at[residual.feature.image] = 0;
        parameters.point_at[residual.point] = 0;
        parameters.camera_at[model.camera_id(residual.feature.image)] = 0;
    }
    std::size_t size = 0;
    const auto place = [&](std::size_t& at, std::size_t block) {
        if (at == AdjustmentParameters::kAbsent) return;
        at = size;
        size += block;
    };
    for (auto& [camera, at] : parameters.camera_at) {
        const CameraId lens = model.lens_of(camera);
        if (lens != camera && parameters.camera_at.contains(lens))
            parameters.owner_of_block[camera] = lens;
        else
            place(at, kIntrinsicsSize);
    }
    for (const auto& [camera, owner] : parameters.owner_of_block)
        parameters.camera_at[camera] = parameters.camera_at.at(owner);
    for (std::size_t& at : parameters.pose_at) place(at, kPoseSize);
    for (std::size_t& at : parameters.point_at) place(at, kPointSize);
    parameters.values.resize(size);
    for (const auto& [camera, at] : parameters.camera_at) {
        if (parameters.owner_of(camera) != camera) continue;
        std::ranges::copy(model.cameras().at(camera).params,
                          parameters.values.begin() + static_cast<std::ptrdiff_t>(at));
    }
    for (std::uint32_t image = 0; image < parameters.pose_at.size(); ++image) {
        if (parameters.pose_at[image] != AdjustmentParameters::kAbsent) {
            write_pose(model.pose(image), &parameters.values[parameters.pose_at[image]]);
        }
    }
    for (std::uint32_t point = 0; point < parameters.point_at.size(); ++point) {
        if (parameters.point_at[point] != AdjustmentParameters::kAbsent) {
            Eigen::Map<Eigen::Vector3d>{&parameters.values[parameters.point_at[point]]} =
                model.points()[point].position;
        }
    }
    return parameters;
}

Eigen::Vector2d shift_to_block(const WorkingModel& model, const AdjustmentParameters& parameters,
                               CameraId camera) {
    const CameraId owner = parameters.owner_of(camera);
    if (owner == camera) return Eigen::Vector2d::Zero();
    return model.cameras().at(owner).principal_point() -
           model.cameras().at(camera).principal_point();
}

bool block_is_free(const AdjustmentParameters& parameters, const AdjustmentScope& scope,
                   CameraId owner) {
    const auto is_free = [&](CameraId camera) {
        return std::ranges::binary_search(scope.free_cameras, camera);
    };
    return is_free(owner) &&
           std::ranges::all_of(parameters.owner_of_block, [&](const auto& shared) {
               return shared.second != owner || is_free(shared.first);
           });
}

std::vector<int> held_intrinsics(const WorkingModel& model, const AdjustmentScope& scope,
                                 CameraId camera) {
    const Camera& of = model.cameras().at(camera);
    const int focals = of.has_two_focals() ? 2 : 1;
    const bool holds_focals = std::ranges::binary_search(scope.held_focal_lengths, camera);
    const bool frees_point = std::ranges::binary_search(scope.free_principal_points, camera);
    std::vector<int> held;
    for (int slot = 0; slot < kIntrinsicsSize; ++slot) {
        const bool is_focal = slot < focals;
        const bool is_point = !is_focal && slot < focals + 2;
        if (slot >= parameter_count(of.model) || (is_focal && holds_focals) ||
            (is_point && !frees_point))
            held.push_back(slot);
    }
    return held;
}

int scale_coordinate(const WorkingModel& model, const AdjustmentScope::Gauge& gauge) {
    const Eigen::Vector3d offset = model.centre(gauge.farthest) - model.centre(gauge.origin);
    const Eigen::Vector3d change = model.pose(gauge.farthest).rotation * offset;
    int coordinate = 0;
    change.cwiseAbs().maxCoeff(&coordinate);
    return coordinate;
}

namespace {

/// The camera with its intrinsics of the parameters; nothing where it takes no part with a block
/// of its own.
std::optional<Camera> refined_camera(const AdjustmentParameters& parameters,
                                     const WorkingModel& model, CameraId camera) {
    const auto at = parameters.camera_at.find(camera);
    if (at == parameters.camera_at.end() || parameters.owner_of(camera) != camera)
        return std::nullopt;
    Camera refined = model.cameras().at(camera);
    std::copy_n(parameters.values.begin() + static_cast<std::ptrdiff_t>(at->second),
                kIntrinsicsSize, refined.params.begin());
    return refined;
}

/// Whether a focal length is one that photographs have. A longer one, as of a telescope, is known
/// from the start.
bool has_common_focal(const Camera& camera) {
    // Guard: over the longer side. COLMAP 3.8's min_focal_length_ratio, and a view of 10 degrees.
    constexpr double kShortest = 0.1;
    constexpr double kLongest = 5.7;
    const double relative = camera.mean_focal() / std::max(camera.width, camera.height);
    return relative >= kShortest && relative <= kLongest;
}

}  // namespace

std::vector<CameraId> senseless_cameras(const AdjustmentParameters& parameters,
                                        const AdjustmentScope& scope, const WorkingModel& model) {
    std::vector<CameraId> senseless;
    for (const CameraId camera : scope.free_cameras) {
        const auto refined = refined_camera(parameters, model, parameters.owner_of(camera));
        if (!refined) continue;
        const bool runs_away =
            has_common_focal(model.cameras().at(camera)) && !has_common_focal(*refined);
        // Expected: that is the question
        if (runs_away || !validate(*refined).ok()) senseless.push_back(camera);
    }
    return senseless;
}

void write_back(const AdjustmentParameters& parameters, const AdjustmentSelection& selection,
                const AdjustmentScope& scope, WorkingModel& model) {
    for (const std::uint32_t image : scope.free_images) {
        const std::size_t at = parameters.pose_at[image];
        if (at != AdjustmentParameters::kAbsent)
            model.set_pose(image, read_pose(&parameters.values[at]));
    }
    for (std::uint32_t point = 0; point < parameters.point_at.size(); ++point) {
        const std::size_t at = parameters.point_at[point];
        if (at == AdjustmentParameters::kAbsent || !selection.point_is_free[point]) continue;
        model.set_position(point, Eigen::Map<const Eigen::Vector3d>(&parameters.values[at]));
    }
    for (const CameraId camera : scope.free_cameras) {
        auto refined = refined_camera(parameters, model, camera);
        if (!refined) continue;
        if (refined->focal_source != FocalSource::kGiven)
            refined->focal_source = FocalSource::kEstimated;
        model.mutable_camera(camera) = *refined;
        model.share_lens(camera);
    }
}

}  // namespace psfm
