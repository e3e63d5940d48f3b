// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/refine_model.h"

#include <map>

#include "stages/reconstruction/thin_points.h"
#include "stages/reconstruction/tracks.h"

namespace psfm {
namespace {

/// Images from which focal lengths are adjusted: two views hardly determine them.
constexpr std::uint32_t kImagesForIntrinsics = 3;

std::size_t observation_count(const WorkingModel& model) {
    std::size_t count = 0;
    for (const WorkingModel::Point& point : model.points()) count += point.track.size();
    return count;
}

/// Cameras that at least so many registered images share, ascending; given ones keep their
/// principal point.
std::vector<CameraId> cameras_with_images(const WorkingModel& model, std::uint32_t images) {
    std::map<CameraId, std::uint32_t> counts;
    for (std::uint32_t image = 0; image < model.image_count(); ++image) {
        if (model.registered(image)) ++counts[model.camera_id(image)];
    }
    std::vector<CameraId> cameras;
    for (const auto& [camera, count] : counts) {
        if (count >= images && model.cameras().at(camera).focal_source != FocalSource::kGiven)
            cameras.push_back(camera);
    }
    return cameras;
}

std::size_t retriangulate(WorkingModel& model, const TrackOptions& options) {
    std::size_t added = 0;
    for (std::uint32_t image = 0; image < model.image_count(); ++image) {
        if (model.registered(image)) added += triangulate_image(model, image, options);
    }
    return added;
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

Result<std::uint32_t> refine_model(WorkingModel& model, bool fix_intrinsics,
                                   const RefinementOptions& refinement,
                                   const SolveOptions& options) {
    std::uint32_t adjustments = 0;
    for (int round = 0; round < refinement.max_rounds; ++round) {
        std::size_t changed = complete_tracks(model, {}, options.tracks);
        changed += merge_tracks(model, {}, options.tracks);
        changed += retriangulate(model, options.tracks);
        const bool free_intrinsics =
            !fix_intrinsics && model.registered_count() >= kImagesForIntrinsics;
        AdjustmentScope scope = full_scope(model, free_intrinsics);
        if (free_intrinsics && refinement.images_for_principal_point > 0) {
            scope.free_principal_points =
                cameras_with_images(model, refinement.images_for_principal_point);
        }
        const bool thin = refinement.points_per_image > 0 &&
                          model.registered_count() >= refinement.thin_from_images;
        if (thin) scope.points = covering_points(model, refinement.points_per_image);
        // Half a megabyte an image, which is not looked at before the next round.
        model.matches().forget();
        const auto report = adjust(model, scope, refinement.adjustment);
        if (!report.ok()) return report.error();
        ++adjustments;
        if (thin) refine_points(model, *scope.points, refinement.adjustment);
        changed += filter_tracks(model, {}, options.tracks);
        remove_weak_images(model, options);
        if (static_cast<double>(changed) <
            refinement.max_change * static_cast<double>(observation_count(model)))
            break;
    }
    return adjustments;
}

std::uint32_t refine_locally(WorkingModel& model, std::span<const std::uint32_t> images,
                             bool fix_intrinsics, const SolveOptions& options) {
    const auto triangulate_all = [&] {
        for (const std::uint32_t image : images) triangulate_image(model, image, options.tracks);
    };
    triangulate_all();
    std::uint32_t adjustments = 0;
    // The second pass works on what the first has filtered (COLMAP's mapper does likewise).
    for (int pass = 0; pass < 2; ++pass) {
        const AdjustmentScope scope =
            local_scope(model, images, options.local_neighbors, !fix_intrinsics);
        if (!adjust(model, scope, options.local_adjustment).ok()) break;
        ++adjustments;
        if (filter_tracks(model, scope.free_images, options.tracks) < 10) break;
        triangulate_all();
    }
    return adjustments;
}

}  // namespace psfm
