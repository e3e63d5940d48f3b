// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <map>
#include <set>

#include "stages/reconstruction/adjust/bundle_adjustment.h"

namespace psfm {
namespace {

std::vector<std::uint32_t> observation_counts(const WorkingModel& model) {
    std::vector<std::uint32_t> counts(model.image_count(), 0);
    for (const WorkingModel::Point& point : model.points()) {
        for (const WorkingModel::Feature& feature : point.track) ++counts[feature.image];
    }
    return counts;
}

/// Cameras whose lens no registered image has beside these, ascending.
std::vector<CameraId> cameras_of_only(const WorkingModel& model,
                                      const std::vector<std::uint32_t>& images) {
    std::map<CameraId, bool> lens_is_free;
    std::set<CameraId> cameras;
    for (std::uint32_t other = 0; other < model.image_count(); ++other) {
        if (!model.registered(other)) continue;
        const CameraId camera = model.camera_id(other);
        cameras.insert(camera);
        auto [entry, added] = lens_is_free.try_emplace(model.lens_of(camera), true);
        entry->second =
            entry->second && std::ranges::binary_search(images, other) && !model.is_held(camera);
    }
    std::vector<CameraId> free;
    for (const CameraId camera : cameras) {
        if (lens_is_free.at(model.lens_of(camera))) free.push_back(camera);
    }
    return free;
}

}  // namespace

std::vector<CameraId> cameras_with_images(const WorkingModel& model, std::uint32_t images) {
    std::map<CameraId, std::uint32_t> counts;
    for (std::uint32_t image = 0; image < model.image_count(); ++image) {
        if (model.registered(image)) ++counts[model.camera_id(image)];
    }
    std::vector<CameraId> cameras;
    for (const auto& [camera, count] : counts) {
        if (count >= images && !model.has_twin(camera) &&
            model.cameras().at(camera).focal_source != FocalSource::kGiven)
            cameras.push_back(camera);
    }
    return cameras;
}

AdjustmentScope full_scope(const WorkingModel& model, bool free_intrinsics) {
    AdjustmentScope scope;
    std::set<CameraId> cameras;
    for (std::uint32_t image = 0; image < model.image_count(); ++image) {
        if (!model.registered(image)) continue;
        scope.free_images.push_back(image);
        cameras.insert(model.camera_id(image));
    }
    scope.point_images = scope.free_images;
    if (free_intrinsics) scope.free_cameras.assign(cameras.begin(), cameras.end());
    const std::vector<std::uint32_t> counts = observation_counts(model);
    const auto best =
        std::ranges::max_element(scope.free_images, {}, [&](std::uint32_t i) { return counts[i]; });
    if (best == scope.free_images.end()) return scope;
    const auto farthest = std::ranges::max_element(scope.free_images, {}, [&](std::uint32_t i) {
        return (model.centre(i) - model.centre(*best)).squaredNorm();
    });
    scope.gauge = AdjustmentScope::Gauge{*best, *farthest};
    return scope;
}

AdjustmentScope local_scope(const WorkingModel& model, std::span<const std::uint32_t> images,
                            std::size_t neighbors, std::size_t longest_moving_track,
                            bool free_intrinsics) {
    std::vector<std::uint32_t> shared(model.image_count(), 0);
    for (const std::uint32_t image : images) {
        for (std::uint32_t feature = 0; feature < model.matches().feature_count(image); ++feature) {
            const std::uint32_t point = model.point_of({image, feature});
            if (point == WorkingModel::kNoPoint) continue;
            for (const WorkingModel::Feature& other : model.points()[point].track)
                ++shared[other.image];
        }
    }
    for (const std::uint32_t image : images) shared[image] = 0;
    std::vector<std::uint32_t> order;
    for (std::uint32_t other = 0; other < model.image_count(); ++other) {
        if (shared[other] > 0) order.push_back(other);
    }
    std::ranges::stable_sort(order, std::greater{}, [&](std::uint32_t i) { return shared[i]; });

    AdjustmentScope scope;
    scope.longest_moving_track = longest_moving_track;
    scope.point_images.assign(images.begin(), images.end());
    scope.free_images = scope.point_images;
    // Two neighbours at least stay where they are: they carry the gauge.
    const std::size_t free_neighbors =
        std::min(neighbors, order.size() >= 2 ? order.size() - 2 : 0);
    scope.free_images.insert(scope.free_images.end(), order.begin(),
                             order.begin() + static_cast<std::ptrdiff_t>(free_neighbors));
    std::ranges::sort(scope.free_images);
    if (free_intrinsics) scope.free_cameras = cameras_of_only(model, scope.free_images);
    return scope;
}

AdjustmentScope region_scope(const WorkingModel& model, std::span<const std::uint32_t> images,
                             bool free_intrinsics) {
    AdjustmentScope scope;
    scope.free_images.assign(images.begin(), images.end());
    scope.point_images = scope.free_images;
    if (free_intrinsics) scope.free_cameras = cameras_of_only(model, scope.free_images);
    return scope;
}

}  // namespace psfm
