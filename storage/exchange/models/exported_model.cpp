// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/exchange/models/exported_model.h"

#include <algorithm>

namespace psfm {
namespace {

template <typename Item, typename Id>
const Item* find_by_id(const std::vector<Item>& items, Id id) {
    const auto found = std::ranges::lower_bound(items, id, {}, &Item::id);
    return found != items.end() && found->id == id ? &*found : nullptr;
}

/// Format: COLMAP's databases know no larger id.
constexpr std::uint64_t kLargestId = 2147483646;

/// The n-th number from 1 on that the list has not.
std::uint32_t free_id(std::span<const std::uint32_t> ids, std::size_t n) {
    auto free = static_cast<std::uint32_t>(n + 1);
    for (const std::uint32_t id : ids) {
        if (id > free) break;
        if (id > 0) ++free;
    }
    return free;
}

/// @param id  ours: a number plus one
std::uint32_t id_in(std::span<const std::uint32_t> ids, std::uint32_t id) {
    if (ids.empty()) return id;
    const std::size_t number = id - 1;
    if (number < ids.size()) return ids[number];
    const std::size_t later = number - ids.size();
    const std::uint64_t next = std::uint64_t{ids.back()} + later + 1;
    if (next <= kLargestId) return static_cast<std::uint32_t>(next);
    const std::size_t above = ids.back() < kLargestId ? kLargestId - ids.back() : 0;
    return free_id(ids, later - above);
}

}  // namespace

ExportedModel renumbered(ExportedModel model, std::span<const std::uint32_t> image_ids,
                         std::span<const std::uint32_t> camera_ids) {
    for (ExportedCamera& camera : model.cameras) camera.id = id_in(camera_ids, camera.id);
    for (ExportedImage& image : model.images) {
        image.id = id_in(image_ids, image.id);
        image.camera_id = id_in(camera_ids, image.camera_id);
    }
    for (ExportedPoint& point : model.points) {
        for (ExportedObservation& seen : point.track)
            seen.image_id = id_in(image_ids, seen.image_id);
        std::ranges::sort(point.track);
    }
    std::ranges::sort(model.cameras, {}, &ExportedCamera::id);
    std::ranges::sort(model.images, {}, &ExportedImage::id);
    return model;
}

void add_remainders(ExportedModel& model, std::span<const ImageSource> sources) {
    for (ExportedImage& image : model.images) {
        if (image.id - 1 >= sources.size()) continue;
        const auto& remainders = sources[image.id - 1].place_remainders;
        const std::size_t count = std::min(image.keypoints.size(), remainders.size() / 2);
        for (std::size_t k = 0; k < count; ++k) {
            image.keypoints[k].x += remainders[2 * k];
            image.keypoints[k].y += remainders[2 * k + 1];
        }
    }
}

void add_repeated(ExportedModel& model, std::span<const std::uint32_t> repeated) {
    for (std::size_t i = 0; i + 2 < repeated.size(); i += 3) {
        const std::uint32_t id = repeated[i] + 1;
        const auto image = std::ranges::lower_bound(model.images, id, {}, &ExportedImage::id);
        if (image == model.images.end() || image->id != id) continue;
        auto& keypoints = image->keypoints;
        const std::uint32_t kept = repeated[i + 1];
        const std::uint32_t beside = repeated[i + 2];
        if (std::max(kept, beside) >= keypoints.size()) continue;
        if (keypoints[kept].point == kNoPoint || keypoints[beside].point != kNoPoint) continue;
        const auto point =
            std::ranges::lower_bound(model.points, keypoints[kept].point, {}, &ExportedPoint::id);
        keypoints[beside].point = point->id;
        const ExportedObservation seen{id, beside};
        point->track.insert(std::ranges::lower_bound(point->track, seen), seen);
    }
}

const ExportedCamera* ExportedModel::find_camera(std::uint32_t id) const {
    return find_by_id(cameras, id);
}

const ExportedImage* ExportedModel::find_image(std::uint32_t id) const {
    return find_by_id(images, id);
}

const ExportedPoint* ExportedModel::find_point(std::uint64_t id) const {
    return find_by_id(points, id);
}

}  // namespace psfm
