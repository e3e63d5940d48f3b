// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/checks/judge_lenses.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <optional>
#include <utility>
#include <vector>

#include "stages/reconstruction/adjust/bundle_adjustment.h"
#include "stages/reconstruction/adjust/observation_noise.h"
#include "stages/reconstruction/adjust/thin_points.h"
#include "stages/reconstruction/checks/model_alone.h"
#include "stages/reconstruction/model/tracks.h"

namespace psfm {
namespace {

using ModelPtr = std::shared_ptr<const Reconstruction>;

bool has_one_coefficient(const Camera& camera) {
    return camera.model == CameraModel::kSimpleRadial && camera.focal_source != FocalSource::kGiven;
}

/// Cameras of one coefficient that enough images share, ascending.
std::vector<CameraId> candidates(const WorkingModel& model, std::uint32_t min_images) {
    std::vector<CameraId> cameras = cameras_with_images(model, min_images);
    std::erase_if(
        cameras, [&](CameraId camera) { return !has_one_coefficient(model.cameras().at(camera)); });
    return cameras;
}

/// Whether the focal length is another one with the second coefficient.
bool has_moved(const Camera& with, const Camera& without, double max_change) {
    return std::abs(with.mean_focal() / without.mean_focal() - 1.0) > max_change;
}

ModelPtr finished(WorkingModel model, const AdjustmentScope& scope,
                  const AdjustmentOptions& adjustment) {
    std::vector<std::uint32_t> others;
    std::ranges::set_difference(points_seen_by(model, {}), *scope.points,
                                std::back_inserter(others));
    refine_points(model, others, adjustment);
    return std::make_shared<const Reconstruction>(model.save());
}

/// Adjusts, and says what error is left [px]; nothing where there is no solution.
/// @errors kCancelled
Result<std::optional<double>> rms_adjusted(WorkingModel& model, const AdjustmentScope& scope,
                                           const AdjustmentOptions& adjustment,
                                           const std::atomic<bool>* cancel) {
    const auto report = adjust(model, scope, adjustment, cancel);
    if (report.ok()) return std::optional(report->rms_after_px);
    if (report.error().code == ErrorCode::kCancelled) return report.error();
    return std::optional<double>();
}

}  // namespace

Result<ModelPtr> judge_lenses(const ModelPtr& model, const ClusterProblem& problem,
                              const CameraTies& ties, const SolveOptions& options,
                              const std::atomic<bool>* cancel) {
    const LensOptions& lenses = options.lenses;
    const bool may_be_asked = std::ranges::any_of(
        model->cameras, [](const auto& camera) { return has_one_coefficient(camera.second); });
    if (lenses.min_images == 0 || !may_be_asked) return ModelPtr();
    const ModelAlone alone(model, problem, ties);
    std::vector<CameraId> cameras = candidates(alone.model, lenses.min_images);
    if (cameras.empty()) return ModelPtr();
    const RefinementOptions& settling = options.settling;
    AdjustmentOptions adjustment =
        fitted_to_noise(alone.model, settling.adjustment, settling.noise);
    adjustment.function_tolerance = std::max(adjustment.function_tolerance, lenses.tolerance);
    AdjustmentScope scope = full_scope(alone.model, true);
    scope.points = covering_points(alone.model, {}, lenses.points_per_image);
    if (settling.images_for_principal_point > 0) {
        scope.free_principal_points =
            cameras_with_images(alone.model, settling.images_for_principal_point);
    }
    WorkingModel without = alone.model;
    const auto rms_without = rms_adjusted(without, scope, adjustment, cancel);
    if (!rms_without.ok()) return rms_without.error();
    if (!*rms_without) return ModelPtr();
    while (!cameras.empty()) {
        WorkingModel with = without;
        for (const CameraId camera : cameras)
            with.mutable_camera(camera).model = CameraModel::kRadial;
        const auto rms_with = rms_adjusted(with, scope, adjustment, cancel);
        if (!rms_with.ok()) return rms_with.error();
        if (!*rms_with || **rms_with > (1.0 - lenses.min_gain) * **rms_without) break;
        const auto moved = std::erase_if(cameras, [&](CameraId camera) {
            return has_moved(with.cameras().at(camera), without.cameras().at(camera),
                             lenses.max_focal_change);
        });
        if (moved == 0) return finished(std::move(with), scope, adjustment);
    }
    return ModelPtr();
}

}  // namespace psfm
