// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/adjust/eliminate_point.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace psfm {

double damping_of(double diagonal, double radius) {
    return std::clamp(diagonal, 1e-6, 1e32) / radius;
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

std::array<const double*, 3> ObservationEvaluator::blocks_of(
    const AdjustmentResidual& residual, const std::vector<double>& values) const {
    const View& view = views_[residual.feature.image];
    return {&values[view.pose_at], &values[layout_.point_at[residual.point]],
            &values[view.intrinsics_at]};
}

double ObservationEvaluator::half_loss(std::size_t observation,
                                       const std::vector<double>& values) const {
    const AdjustmentResidual& residual = selection_.residuals[observation];
    const Observed& observed = observed_[observation];
    const View& view = views_[residual.feature.image];
    const auto blocks = blocks_of(residual, values);
    Eigen::Vector2d error;
    if (!evaluate_reprojection(view.model, {observed.x, observed.y}, observed.inverse_sigma,
                               blocks.data(), error.data(), nullptr)) {
        return std::numeric_limits<double>::infinity();
    }
    return SoftLOne(error.squaredNorm(), options_.loss_scale_px).half_loss();
}

void ObservationEvaluator::linearize(std::size_t observation, const std::vector<double>& values,
                                     LinearizedObservation& out) const {
    const AdjustmentResidual& residual = selection_.residuals[observation];
    const Observed& observed = observed_[observation];
    const View& view = views_[residual.feature.image];
    const auto blocks = blocks_of(residual, values);
    Eigen::Matrix<double, 2, kPoseSize, Eigen::RowMajor> by_pose;
    Eigen::Matrix<double, 2, kPointSize, Eigen::RowMajor> by_point;
    Eigen::Matrix<double, 2, kIntrinsicsSize, Eigen::RowMajor> by_intrinsics;
    std::array<double*, 3> jacobians{by_pose.data(), by_point.data(), by_intrinsics.data()};
    evaluate_reprojection(view.model, {observed.x, observed.y}, observed.inverse_sigma,
                          blocks.data(), out.residual.data(), jacobians.data());
    const SoftLOne loss(out.residual.squaredNorm(), options_.loss_scale_px);
    const double weight = 1.0 / std::sqrt(loss.inverse_slope());
    out.residual *= weight;
    out.pose = view.column;
    out.intrinsics = view.intrinsics;
    out.by_pose = weight * by_pose.leftCols<6>();
    if (columns_.held_translation && view.column != AdjustmentColumns::kHeld &&
        *columns_.held_translation >= view.column && *columns_.held_translation < view.column + 6) {
        out.by_pose.col(static_cast<Eigen::Index>(*columns_.held_translation - view.column))
            .setZero();
    }
    out.by_point = weight * by_point;
    if (view.intrinsics != nullptr) {
        for (std::size_t i = 0; i < view.intrinsics->slots.size(); ++i) {
            out.by_intrinsics.col(static_cast<Eigen::Index>(i)) =
                weight * by_intrinsics.col(view.intrinsics->slots[i]);
        }
    }
}

void ObservationEvaluator::couple(EliminatedPoint& point) {
    for (std::size_t i = 0; i < point.observations.size(); ++i) {
        const LinearizedObservation& seen = point.observations[i];
        if (seen.pose != AdjustmentColumns::kHeld) {
            auto& pose = point.poses.emplace_back();
            pose.column = seen.pose;
            pose.size = 6;
            pose.observation = i;
            pose.cross.noalias() = seen.by_pose.transpose() * seen.by_point;
        }
        if (seen.intrinsics == nullptr) continue;
        const auto size = static_cast<int>(seen.intrinsics->slots.size());
        auto found = std::ranges::lower_bound(point.intrinsics, seen.intrinsics->column, {},
                                              &EliminatedPoint::Coupling<kIntrinsicsSize>::column);
        if (found == point.intrinsics.end() || found->column != seen.intrinsics->column) {
            found = point.intrinsics.emplace(found);
            found->column = seen.intrinsics->column;
            found->size = size;
        }
        found->cross.topRows(size).noalias() +=
            seen.by_intrinsics.leftCols(size).transpose() * seen.by_point;
    }
    for (auto& pose : point.poses) pose.scaled.noalias() = pose.cross * point.inverse;
    for (auto& camera : point.intrinsics) {
        camera.scaled.topRows(camera.size).noalias() =
            camera.cross.topRows(camera.size) * point.inverse;
    }
}

void ObservationEvaluator::eliminate(std::size_t first, std::size_t count,
                                     const std::vector<double>& values, double radius,
                                     EliminatedPoint& out) const {
    out.observations.resize(count);
    out.poses.clear();
    out.intrinsics.clear();
    out.is_free = selection_.point_is_free[selection_.residuals[first].point];
    out.inverse.setZero();
    out.gradient.setZero();
    Eigen::Matrix3d block = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < count; ++i) {
        LinearizedObservation& seen = out.observations[i];
        linearize(first + i, values, seen);
        block.noalias() += seen.by_point.transpose() * seen.by_point;
        out.gradient.noalias() += seen.by_point.transpose() * seen.residual;
    }
    if (out.is_free) {
        for (int i = 0; i < 3; ++i) out.damping[i] = damping_of(block(i, i), radius);
        block.diagonal() += out.damping;
        out.inverse = block.inverse();
    }
    couple(out);
}

}  // namespace psfm
