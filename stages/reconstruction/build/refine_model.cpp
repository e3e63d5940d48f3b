// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/build/refine_model.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <numeric>
#include <utility>
#include <vector>

#include "stages/reconstruction/adjust/observation_noise.h"
#include "stages/reconstruction/adjust/thin_points.h"
#include "stages/reconstruction/model/tracks.h"

namespace psfm {
namespace {

/// Guard: images from which focal lengths are adjusted: two views hardly determine them.
constexpr std::uint32_t kImagesForIntrinsics = 3;
/// Guard: of time: observations filtered that are worth a second local adjustment; COLMAP's mapper
/// asks for a part of them instead. Ours; not tuned, and what fewer would change is not measured.
constexpr std::uint32_t kFilteredForAnother = 10;
/// Guard: of time: a loss that the next round would leave at this part or more is steady. Ours; not
/// tuned.
constexpr double kSteadyLoss = 0.8;

/// Of the points that one of the images sees; of all points, when there are none.
std::size_t observation_count(const WorkingModel& model, std::span<const std::uint32_t> images) {
    std::size_t count = 0;
    for (const std::uint32_t point : points_seen_by(model, images))
        count += model.points()[point].track.size();
    return count;
}

/// Ascending.
std::vector<std::uint32_t> registered_images(const WorkingModel& model) {
    std::vector<std::uint32_t> images;
    for (std::uint32_t image = 0; image < model.image_count(); ++image) {
        if (model.registered(image)) images.push_back(image);
    }
    return images;
}

/// The images, and all that share so many points with them that they hold each other; ascending.
std::vector<std::uint32_t> with_neighbors(const WorkingModel& model,
                                          const std::vector<std::uint32_t>& images,
                                          std::uint32_t shared_points) {
    std::vector<std::uint32_t> shared(model.image_count(), 0);
    for (const std::uint32_t point : points_seen_by(model, images)) {
        for (const WorkingModel::Feature& feature : model.points()[point].track)
            ++shared[feature.image];
    }
    for (const std::uint32_t image : images) shared[image] = shared_points;
    std::vector<std::uint32_t> region;
    for (std::uint32_t image = 0; image < model.image_count(); ++image) {
        if (model.registered(image) && shared[image] >= shared_points) region.push_back(image);
    }
    return region;
}

/// The scope of one round: all of the model when no region is given.
AdjustmentScope scope_of(const WorkingModel& model, std::span<const std::uint32_t> region,
                         bool free_intrinsics, const RefinementOptions& refinement) {
    AdjustmentScope scope = region.empty() ? full_scope(model, free_intrinsics)
                                           : region_scope(model, region, free_intrinsics);
    if (region.empty() && free_intrinsics && refinement.images_for_principal_point > 0) {
        scope.free_principal_points =
            cameras_with_images(model, refinement.images_for_principal_point);
    }
    const bool thin =
        refinement.points_per_image > 0 && model.registered_count() >= refinement.thin_from_images;
    if (thin) scope.points = covering_points(model, region, refinement.points_per_image);
    return scope;
}

/// By feature of the images, one image after the other: whether a point is seen there.
std::vector<std::uint8_t> observed_features(const WorkingModel& model,
                                            std::span<const std::uint32_t> images) {
    std::vector<std::uint8_t> observed;
    for (const std::uint32_t image : images) {
        for (std::uint32_t feature = 0; feature < model.matches().feature_count(image); ++feature)
            observed.push_back(model.point_of({image, feature}) != WorkingModel::kNoPoint ? 1 : 0);
    }
    return observed;
}

std::size_t count_differences(std::span<const std::uint8_t> some,
                              std::span<const std::uint8_t> others) {
    return std::transform_reduce(some.begin(), some.end(), others.begin(), std::size_t{0},
                                 std::plus(), std::not_equal_to());
}

/// What a round of completing, adjusting and filtering has done.
struct Round {
    AdjustmentOptions adjustment;  ///< as it was made
    std::size_t changed = 0;       ///< observations that came or went, points that were merged
};

/// @param images  those of the region, or all that are registered
/// @param min_tolerance  function_tolerance at least
Result<Round> refine_once(WorkingModel& model, const std::vector<std::uint32_t>& region,
                          std::span<const std::uint32_t> images, double min_tolerance,
                          const RefinementOptions& refinement, const RefineContext& context) {
    Round round;
    TrackOptions tracks = context.options.tracks;
    tracks.max_error_px = max_error_by_noise(model, refinement.adjustment, refinement.noise,
                                             context.options.tracks.max_error_px);
    const std::vector<std::uint8_t> observed = observed_features(model, images);
    complete_tracks(model, region, tracks);
    round.changed = merge_tracks(model, region, tracks);
    for (const std::uint32_t image : images) triangulate_image(model, image, tracks);
    const bool free_intrinsics =
        !context.fix_intrinsics && model.registered_count() >= kImagesForIntrinsics;
    const AdjustmentScope scope = scope_of(model, region, free_intrinsics, refinement);
    // Half a megabyte an image, which is not looked at before the next round.
    model.matches().forget();
    round.adjustment = fitted_to_noise(model, refinement.adjustment, refinement.noise);
    round.adjustment.function_tolerance =
        std::max(round.adjustment.function_tolerance, min_tolerance);
    const auto report = adjust(model, scope, round.adjustment, context.cancel);
    if (!report.ok()) return report.error();
    if (scope.points) {
        std::vector<std::uint32_t> others;
        std::ranges::set_difference(points_seen_by(model, region), *scope.points,
                                    std::back_inserter(others));
        refine_points(model, others, round.adjustment);
    }
    filter_tracks(model, region, tracks);
    // What comes and goes again does so in every round.
    round.changed += count_differences(observed, observed_features(model, images));
    return round;
}

/// Whether another round would do no more than this one: neither observations nor the loss change.
bool is_steady(const Round& round, const WorkingModel& model,
               const std::vector<std::uint32_t>& region, const RefinementOptions& refinement) {
    const auto observations = static_cast<double>(observation_count(model, region));
    const AdjustmentOptions next = fitted_to_noise(model, round.adjustment, refinement.noise);
    return static_cast<double>(round.changed) < refinement.max_change * observations &&
           next.loss_scale_px >= kSteadyLoss * round.adjustment.loss_scale_px;
}

/// Adjusts a region of the model, or all of it when none is given.
Result<std::uint32_t> refine(WorkingModel& model, const std::vector<std::uint32_t>& region,
                             const RefinementOptions& refinement, const RefineContext& context) {
    const double tolerance = refinement.adjustment.function_tolerance;
    bool was_steady = false;
    std::uint32_t adjustments = 0;
    for (int number = 1; number <= refinement.max_rounds; ++number) {
        const bool is_last = was_steady || number == refinement.max_rounds;
        const auto round =
            refine_once(model, region, region.empty() ? registered_images(model) : region,
                        is_last ? tolerance : refinement.round_tolerance, refinement, context);
        if (!round.ok()) return round.error();
        ++adjustments;
        // A region is chosen anew where one of its images is gone.
        if (remove_weak_images(model, context.options) > 0 && !region.empty()) break;
        if (is_last) break;
        was_steady = is_steady(*round, model, region, refinement);
        if (was_steady && round->adjustment.function_tolerance <= tolerance) break;
    }
    return adjustments;
}

}  // namespace

std::uint32_t remove_weak_images(WorkingModel& model, const SolveOptions& options) {
    std::uint32_t removed = 0;
    for (std::uint32_t image = 0; image < model.image_count(); ++image) {
        if (!model.registered(image)) continue;
        std::uint32_t observations = 0;
        for (std::uint32_t feature = 0; feature < model.matches().feature_count(image); ++feature) {
            if (model.point_of({image, feature}) != WorkingModel::kNoPoint) ++observations;
        }
        if (observations >= options.min_observations) continue;
        model.remove_image(image);
        ++removed;
    }
    return removed;
}

Result<std::uint32_t> refine_model(WorkingModel& model, const RefinementOptions& refinement,
                                   const RefineContext& context) {
    return refine(model, {}, refinement, context);
}

Result<std::uint32_t> refine_changed_model(WorkingModel& model, SolveEffort effort,
                                           const RefineContext& context) {
    const SolveOptions& options = context.options;
    const bool is_rough = effort == SolveEffort::kRough;
    return refine_model(model, is_rough ? options.large_growth : options.growth, context);
}

Result<std::uint32_t> refine_around(WorkingModel& model, std::vector<std::uint32_t> images,
                                    std::size_t at_least, const RefineContext& context) {
    const SolveOptions& options = context.options;
    std::erase_if(images, [&](std::uint32_t image) { return !model.registered(image); });
    if (images.empty()) return 0U;
    std::vector<std::uint32_t> region = with_neighbors(model, images, options.neighbor_points);
    for (std::size_t before = 0; region.size() < at_least && before < region.size();) {
        before = region.size();
        region = with_neighbors(model, region, options.neighbor_points);
    }
    // The others hold the gauge.
    const double most = options.max_region * static_cast<double>(model.registered_count());
    if (static_cast<double>(region.size()) > most) region.clear();
    return refine(model, region, options.large_growth, context);
}

Result<std::uint32_t> refine_joined(WorkingModel& model, const Recycling& joined,
                                    const SolvePlan& plan, const RefineContext& context) {
    if (plan.scope == SolveScope::kAll) return refine_changed_model(model, plan.effort, context);
    std::vector<std::uint32_t> images;
    std::ranges::set_union(joined.images, joined.joint, std::back_inserter(images));
    const std::size_t at_least = joined.images.size() + context.options.images_around_joint;
    return refine_around(model, std::move(images), at_least, context);
}

Result<std::uint32_t> refine_joined_locally(WorkingModel& model,
                                            std::span<const std::uint32_t> joined,
                                            const RefineContext& context) {
    complete_tracks(model, joined, context.options.tracks);
    merge_tracks(model, joined, context.options.tracks);
    return refine_locally(model, joined, context);
}

Result<std::uint32_t> refine_grown(WorkingModel& model, std::uint32_t grown, const SolvePlan& plan,
                                   const RefineContext& context) {
    if (plan.scope == SolveScope::kAll) return refine_changed_model(model, plan.effort, context);
    std::vector<std::uint32_t> newest = registered_images(model);
    newest.erase(newest.begin(),
                 newest.end() - std::min<std::ptrdiff_t>(grown, std::ssize(newest)));
    return refine_around(model, std::move(newest), 0, context);
}

Result<std::uint32_t> refine_locally(WorkingModel& model, std::span<const std::uint32_t> images,
                                     const RefineContext& context) {
    const SolveOptions& options = context.options;
    const auto triangulate_all = [&] {
        for (const std::uint32_t image : images) triangulate_image(model, image, options.tracks);
    };
    triangulate_all();
    std::uint32_t adjustments = 0;
    // The second pass works on what the first has filtered (COLMAP's mapper does likewise).
    for (int pass = 0; pass < 2; ++pass) {
        const AdjustmentScope scope =
            local_scope(model, images, options.local_neighbors, options.local_longest_track,
                        !context.fix_intrinsics);
        const auto report = adjust(model, scope, options.local_adjustment, context.cancel);
        if (!report.ok()) return report.error();
        ++adjustments;
        if (filter_tracks(model, scope.free_images, options.tracks) < kFilteredForAnother) break;
        triangulate_all();
    }
    return adjustments;
}

}  // namespace psfm
