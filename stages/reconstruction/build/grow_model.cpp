// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/build/grow_model.h"

#include <algorithm>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "stages/reconstruction/build/refine_model.h"
#include "stages/reconstruction/model/cancelled.h"

namespace psfm {
namespace {

using Feature = WorkingModel::Feature;

/// Guard: of time: an image that could not be placed is asked again once it sees so many points for
/// each so many of the last time, twenty per cent more. Ours; not tuned.
constexpr std::uint32_t kAgainAt = 6;
constexpr std::uint32_t kAgainFor = 5;

/// What an image needs to be placed.
struct Demand {
    AbsolutePoseOptions pose;
    std::uint32_t observations = 0;                 ///< once its surroundings are adjusted
    std::vector<std::uint32_t> points_at_last_try;  ///< by image
};

/// Of any image; then of those that are left over, if these are asked for less.
std::vector<Demand> demands(const SolveOptions& options, std::size_t images) {
    const std::vector<std::uint32_t> never(images, 0);
    std::vector<Demand> demands = {
        {options.absolute_pose, options.absolute_pose.min_inliers, never}};
    const FewPointsOptions& few = options.few_points;
    if (few.min_points > 0 && few.min_points < options.absolute_pose.min_inliers) {
        demands.push_back({options.absolute_pose, few.min_observations, never});
        demands.back().pose.min_inliers = few.min_points;
        demands.back().pose.min_inlier_ratio = few.min_inlier_ratio;
    }
    return demands;
}

/// The unregistered image that sees the model best, among those that see more than when the same
/// was last asked of them.
std::optional<std::uint32_t> next_image(const WorkingModel& model, const Demand& demand) {
    std::optional<std::uint32_t> best;
    for (std::uint32_t image = 0; image < model.image_count(); ++image) {
        if (model.registered(image)) continue;
        const std::uint32_t visible = model.visible_points(image);
        if (visible < demand.pose.min_inliers ||
            kAgainFor * visible < kAgainAt * demand.points_at_last_try[image])
            continue;
        if (!best || model.visible_score(image) > model.visible_score(*best)) best = image;
    }
    return best;
}

/// Whether a placed image has the lens of this one.
bool lens_is_placed(const WorkingModel& model, std::uint32_t image) {
    for (std::uint32_t other = 0; other < model.image_count(); ++other) {
        if (model.registered(other) &&
            model.lens_of(model.camera_id(other)) == model.lens_of(model.camera_id(image)))
            return true;
    }
    return false;
}

bool camera_is_settled(const WorkingModel& model, std::uint32_t image) {
    return model.camera(image).focal_source != FocalSource::kUnknown ||
           model.is_held(model.camera_id(image)) || lens_is_placed(model, image);
}

/// Pose from the points that the image's features are matched with.
bool register_image(WorkingModel& model, std::uint32_t image, const ClusterProblem& problem,
                    const AbsolutePoseOptions& options) {
    std::vector<Feature> features;
    std::vector<std::uint32_t> points;
    std::vector<Eigen::Vector2d> pixels;
    std::vector<Eigen::Vector3d> positions;
    for (std::uint32_t index = 0; index < model.matches().feature_count(image); ++index) {
        const Feature feature{image, index};
        const std::size_t first = points.size();
        for (const Feature& match : model.matches().matches(feature)) {
            const std::uint32_t point = model.point_of(match);
            if (point == WorkingModel::kNoPoint) continue;
            if (std::find(points.begin() + static_cast<std::ptrdiff_t>(first), points.end(),
                          point) != points.end())
                continue;
            features.push_back(feature);
            points.push_back(point);
            pixels.push_back(model.pixel(feature));
            positions.push_back(model.points()[point].position);
        }
    }
    const bool refine_focal = !problem.fix_intrinsics && !camera_is_settled(model, image);
    const std::uint64_t seed = problem.seed ^ problem.images[image].content_hash;
    const auto pose =
        estimate_absolute_pose(pixels, positions, model.camera(image), refine_focal, options, seed);
    if (!pose.ok()) return false;  // Expected: too few of the points agree with one pose
    if (refine_focal) {
        model.mutable_camera(model.camera_id(image)) = pose->camera;
        model.share_lens(model.camera_id(image));
    }
    model.set_pose(image, pose->cam_from_world);
    for (const std::uint32_t inlier : pose->inliers) {
        if (model.point_of(features[inlier]) == WorkingModel::kNoPoint) {
            model.add_observation(points[inlier], features[inlier]);
        }
    }
    return true;
}

/// What an image that went has told of its lens, unless others have it.
/// @param camera  what was known before
void forget_lens(WorkingModel& model, std::uint32_t image, const Camera& camera) {
    if (lens_is_placed(model, image)) return;
    model.mutable_camera(model.camera_id(image)) = camera;
    model.share_lens(model.camera_id(image));
}

/// Structure around a newly registered image. One whose observations cannot be adjusted has a pose
/// that is none, and goes.
/// @return whether the image keeps enough observations
/// @errors kCancelled
Result<bool> settle_image(SolveDraft& draft, std::uint32_t image, std::uint32_t min_observations,
                          const SolveContext& context) {
    WorkingModel& model = draft.model;
    const auto adjustments = refine_locally(model, std::span(&image, 1), context.refining());
    if (!adjustments.ok() && adjustments.error().code == ErrorCode::kDegenerate) {
        model.remove_image(image);
        return false;
    }
    if (!adjustments.ok()) return adjustments.error();
    draft.statistics.local_adjustments += *adjustments;
    std::uint32_t observations = 0;
    for (std::uint32_t index = 0; index < model.matches().feature_count(image); ++index) {
        if (model.point_of({image, index}) != WorkingModel::kNoPoint) ++observations;
    }
    if (observations >= min_observations) return true;
    model.remove_image(image);
    return false;
}

/// Adjusts a model that has grown enough since the last time.
Result<void> adjust_grown(SolveDraft& draft, const SolveContext& context) {
    const SolvePlan plan = plan_from(draft, context);
    if (!plan.due.full_adjustment) return {};
    const std::uint32_t grown =
        draft.model.registered_count() - draft.state.images_at_full_adjustment;
    const auto adjustments = refine_grown(draft.model, grown, plan, context.refining());
    if (!adjustments.ok()) return adjustments.error();
    draft.statistics.full_adjustments += *adjustments;
    draft.state.images_at_full_adjustment = draft.model.registered_count();
    return {};
}

}  // namespace

Result<void> grow_model(SolveDraft& draft, const SolveContext& context, std::uint32_t at_most) {
    WorkingModel& model = draft.model;
    std::vector<Demand> asked = demands(context.options, model.image_count());
    const std::uint32_t before = draft.statistics.registered;
    while (draft.statistics.registered - before < at_most) {
        std::optional<std::uint32_t> image;
        auto demand = asked.begin();
        for (; demand != asked.end(); ++demand) {
            image = next_image(model, *demand);
            if (image) break;
        }
        if (!image) break;
        if (const auto going_on = not_cancelled(context.cancel); !going_on.ok())
            return going_on.error();
        demand->points_at_last_try[*image] = model.visible_points(*image);
        const Camera camera = model.camera(*image);
        if (!register_image(model, *image, context.problem, demand->pose)) continue;
        const auto stays = settle_image(draft, *image, demand->observations, context);
        if (!stays.ok()) return stays.error();
        if (!*stays) {
            forget_lens(model, *image, camera);
            continue;
        }
        ++draft.statistics.registered;
        if (const auto adjusted = adjust_grown(draft, context); !adjusted.ok())
            return adjusted.error();
    }
    return {};
}

}  // namespace psfm
