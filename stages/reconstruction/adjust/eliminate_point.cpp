// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/adjust/eliminate_point.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

namespace psfm {
namespace {

EliminatedPoint::Coupling<6> couple_pose(const EliminatedPoint& point, std::size_t observation) {
    const LinearizedObservation& seen = point.observations[observation];
    EliminatedPoint::Coupling<6> pose;
    pose.column = seen.pose;
    pose.size = 6;
    pose.observation = observation;
    pose.cross.noalias() = seen.by_pose.transpose() * seen.by_point;
    pose.eliminated.noalias() = -pose.cross * point.inverse;
    return pose;
}

void couple_intrinsics(const LinearizedObservation& seen, EliminatedPoint& point) {
    const auto size = static_cast<Eigen::Index>(seen.intrinsics->slots.size());
    auto found = std::ranges::lower_bound(point.intrinsics, seen.intrinsics->column, {},
                                          &EliminatedPoint::Coupling<kIntrinsicsSize>::column);
    if (found == point.intrinsics.end() || found->column != seen.intrinsics->column) {
        EliminatedPoint::Coupling<kIntrinsicsSize> camera{seen.intrinsics->column, size, 0, {}, {}};
        camera.cross.setZero();
        camera.eliminated.setZero();
        found = point.intrinsics.insert(found, camera);
    }
    found->cross.topRows(size).noalias() +=
        seen.by_intrinsics.leftCols(size).transpose() * seen.by_point;
}

}  // namespace

double damping_of(double diagonal, double radius) {
    constexpr double kLeastDiagonal = 1e-6;  // Guard: min_lm_diagonal of Ceres 2.1
    constexpr double kMostDiagonal = 1e32;   // Guard: and its max_lm_diagonal
    return std::clamp(diagonal, kLeastDiagonal, kMostDiagonal) / radius;
}

ObservationEvaluator::ObservationEvaluator(const WorkingModel& model,
                                           const AdjustmentSelection& selection,
                                           const AdjustmentColumns& columns,
                                           const AdjustmentOptions& options,
                                           const AdjustmentParameters& layout)
    : selection_(selection),
      columns_(columns),
      options_(options),
      layout_(layout),
      views_(model.image_count()) {
    std::vector<Eigen::Vector2f> shifts(model.image_count(), Eigen::Vector2f::Zero());
    for (std::uint32_t image = 0; image < views_.size(); ++image) {
        if (layout.pose_at[image] == AdjustmentParameters::kAbsent) continue;
        const CameraId camera = model.camera_id(image);
        views_[image] = {model.camera(image).model, layout.pose_at[image],
                         layout.camera_at.at(camera), columns.pose[image],
                         columns.of(model, camera)};
        shifts[image] = shift_to_block(model, layout, camera).cast<float>();
    }
    observed_.reserve(selection.residuals.size());
    for (const AdjustmentResidual& residual : selection.residuals) {
        const Keypoint& keypoint = model.keypoint(residual.feature);
        const Eigen::Vector2f& shift = shifts[residual.feature.image];
        observed_.push_back({keypoint.x + shift.x(), keypoint.y + shift.y(),
                             1.0 / observation_sigma(keypoint, options)});
    }
}

AdjustmentState ObservationEvaluator::at(const std::vector<double>& values) const {
    AdjustmentState at{values, std::vector<PosedCamera>(views_.size())};
    for (std::size_t image = 0; image < views_.size(); ++image) {
        const View& view = views_[image];
        if (view.pose_at == AdjustmentParameters::kAbsent) continue;
        at.cameras[image] = {view.model, &values[view.pose_at], &values[view.intrinsics_at]};
    }
    return at;
}

Reprojection ObservationEvaluator::reproject(std::size_t observation,
                                             const AdjustmentState& at) const {
    const AdjustmentResidual& residual = selection_.residuals[observation];
    return {at.cameras[residual.feature.image],
            Eigen::Map<const Eigen::Vector3d>(&at.values[layout_.point_at[residual.point]])};
}

double ObservationEvaluator::half_loss(std::size_t observation, const AdjustmentState& at) const {
    const Reprojection seen = reproject(observation, at);
    if (!seen.in_front()) return std::numeric_limits<double>::infinity();
    const Eigen::Vector2d error = observed_[observation].residual(seen.pixel());
    return SoftLOne(error.squaredNorm(), options_.loss_scale_px).half_loss();
}

void ObservationEvaluator::linearize(std::size_t observation, const AdjustmentState& at,
                                     LinearizedObservation& out) const {
    const View& view = views_[selection_.residuals[observation].feature.image];
    const Observed& observed = observed_[observation];
    const Reprojection seen = reproject(observation, at);
    const Eigen::Vector2d error = observed.residual(seen.pixel());
    const SoftLOne loss(error.squaredNorm(), options_.loss_scale_px);
    const double weight = 1.0 / std::sqrt(loss.inverse_slope());
    out.residual = weight * error;
    seen.derivatives(weight * observed.inverse_sigma, out);
    out.pose = view.column;
    out.intrinsics = view.intrinsics;
    if (columns_.held_translation && view.column != AdjustmentColumns::kHeld &&
        *columns_.held_translation >= view.column && *columns_.held_translation < view.column + 6) {
        out.by_pose.col(static_cast<Eigen::Index>(*columns_.held_translation - view.column))
            .setZero();
    }
    if (view.intrinsics == nullptr) return;
    // Slots ascend, so that none is overwritten before it is read.
    for (std::size_t i = 0; i < view.intrinsics->slots.size(); ++i) {
        out.by_intrinsics.col(static_cast<Eigen::Index>(i)) =
            out.by_intrinsics.col(view.intrinsics->slots[i]);
    }
}

void ObservationEvaluator::linearize_point(std::size_t first, std::size_t count,
                                           const AdjustmentState& at, double radius,
                                           LinearizedPoint& out) const {
    out.observations.resize(count);
    out.is_free = selection_.point_is_free[selection_.residuals[first].point];
    out.inverse.setZero();
    out.gradient.setZero();
    Eigen::Matrix3d block = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < count; ++i) {
        LinearizedObservation& seen = out.observations[i];
        linearize(first + i, at, seen);
        block.noalias() += seen.by_point.transpose() * seen.by_point;
        out.gradient.noalias() += seen.by_point.transpose() * seen.residual;
    }
    if (!out.is_free) return;
    for (int i = 0; i < 3; ++i) out.damping[i] = damping_of(block(i, i), radius);
    block.diagonal() += out.damping;
    out.inverse = block.inverse();
}

void ObservationEvaluator::eliminate(std::size_t first, std::size_t count,
                                     const AdjustmentState& at, double radius,
                                     EliminatedPoint& out) const {
    linearize_point(first, count, at, radius, out);
    out.poses.clear();
    out.intrinsics.clear();
    for (std::size_t i = 0; i < count; ++i) {
        const LinearizedObservation& seen = out.observations[i];
        if (seen.pose != AdjustmentColumns::kHeld) out.poses.push_back(couple_pose(out, i));
        if (seen.intrinsics != nullptr) couple_intrinsics(seen, out);
    }
    for (auto& camera : out.intrinsics) {
        camera.eliminated.topRows(camera.size).noalias() =
            -camera.cross.topRows(camera.size) * out.inverse;
    }
}

}  // namespace psfm
