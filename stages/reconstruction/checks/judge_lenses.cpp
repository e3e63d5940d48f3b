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

/// Cameras of one coefficient that enough images share, ascending.
std::vector<CameraId> candidates(const WorkingModel& model, std::uint32_t min_images) {
    std::vector<CameraId> cameras = cameras_with_images(model, min_images);
    std::erase_if(
        cameras, [&](CameraId camera) { return !has_one_coefficient(model.cameras().at(camera)); });
    return cameras;
}

/// Part by which the focal length is another one.
double focal_change(const Camera& with, const Camera& without) {
    return std::abs(with.mean_focal() / without.mean_focal() - 1.0);
}

ModelPtr finished(WorkingModel model, const AdjustmentScope& scope,
                  const AdjustmentOptions& adjustment) {
    std::vector<std::uint32_t> others;
    std::ranges::set_difference(points_seen_by(model, {}), *scope.points,
                                std::back_inserter(others));
    refine_points(model, others, adjustment);
    return std::make_shared<const Reconstruction>(model.save());
}

/// A model adjusted, and the error that is left [px].
struct LensTrial {
    WorkingModel model;
    double rms_px = 0.0;
};

/// What is asked of one model: the same points, adjusted with one question after the other.
struct LensQuestion {
    AdjustmentScope scope;
    AdjustmentOptions options;
    const std::atomic<bool>* cancel;

    /// @return nothing where there is no solution @errors kCancelled
    Result<std::optional<LensTrial>> adjusted(WorkingModel model) const {
        const auto report = adjust(model, scope, options, cancel);
        if (report.ok()) return std::optional(LensTrial{std::move(model), report->rms_after_px});
        // Expected: a lens with which nothing can be adjusted is no lens of the photographs
        if (report.error().code == ErrorCode::kCancelled) return report.error();
        return std::optional<LensTrial>();
    }
};

/// The model with a second coefficient for some cameras, adjusted.
Result<std::optional<LensTrial>> extended(const LensQuestion& question, WorkingModel model,
                                          const std::vector<CameraId>& cameras) {
    for (const CameraId camera : cameras) model.mutable_camera(camera).model = CameraModel::kRadial;
    return question.adjusted(std::move(model));
}

/// Whether the scene determines the focal lengths that have moved: the error grows with them held
/// where they were, by min_focal_curvature times the square of the change at least.
Result<bool> are_determined(LensQuestion question, const WorkingModel& without,
                            const LensTrial& with, const std::vector<CameraId>& cameras,
                            const std::vector<CameraId>& moved, const LensOptions& lenses) {
    if (moved.empty()) return true;
    question.scope.held_focal_lengths = moved;
    const auto held = extended(question, without, cameras);
    if (!held.ok()) return held.error();
    if (!*held) return false;
    double change = 0.0;
    for (const CameraId camera : moved) {
        change = std::max(
            change, focal_change(with.model.cameras().at(camera), without.cameras().at(camera)));
    }
    return (*held)->rms_px / with.rms_px - 1.0 >= lenses.min_focal_curvature * change * change;
}

}  // namespace

bool has_one_coefficient(const Camera& camera) {
    return camera.model == CameraModel::kSimpleRadial && camera.focal_source != FocalSource::kGiven;
}

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
    const LensQuestion question{scope, adjustment, cancel};
    const auto adjusted = question.adjusted(alone.model);
    if (!adjusted.ok()) return adjusted.error();
    if (!*adjusted) return ModelPtr();
    const LensTrial& without = **adjusted;
    while (!cameras.empty()) {
        auto with = extended(question, without.model, cameras);
        if (!with.ok()) return with.error();
        if (!*with || (*with)->rms_px > (1.0 - lenses.min_gain) * without.rms_px) break;
        std::vector<CameraId> moved = cameras;
        std::erase_if(moved, [&](CameraId camera) {
            return focal_change((*with)->model.cameras().at(camera),
                                without.model.cameras().at(camera)) <= lenses.max_focal_change;
        });
        const auto is_right =
            are_determined(question, without.model, **with, cameras, moved, lenses);
        if (!is_right.ok()) return is_right.error();
        if (*is_right) return finished(std::move((*with)->model), scope, adjustment);
        std::erase_if(cameras,
                      [&](CameraId camera) { return std::ranges::binary_search(moved, camera); });
    }
    return ModelPtr();
}

}  // namespace psfm
