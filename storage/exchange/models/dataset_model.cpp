// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/exchange/models/dataset_model.h"

#include <algorithm>
#include <set>
#include <utility>

#include "storage/exchange/models/distinct_points.h"

namespace psfm {
namespace {

/// The place of a feature in its image's picture. The image's own camera counts: that of the view
/// is the one the picture was made with, which differs by less than is to be seen.
Eigen::Vector2d moved(const ExportedKeypoint& keypoint, const Camera& camera,
                      const UndistortedView& view) {
    const UndistortedView exact{camera, view.picture, view.quarter_turns};
    return picture_from_photo(exact, {keypoint.x, keypoint.y});
}

}  // namespace

ExportedModel dataset_model(const ExportedModel& model, std::span<const UndistortedView> views,
                            std::span<const std::optional<DatasetImage>> images,
                            const Eigen::Vector3d& origin) {
    ExportedModel result;
    std::set<std::uint32_t> used;
    std::set<std::uint32_t> left_out;
    for (std::size_t i = 0; i < model.images.size(); ++i) {
        const ExportedImage& image = model.images[i];
        if (!images[i]) {
            left_out.insert(image.id);
            continue;
        }
        const UndistortedView& view = views[images[i]->view];
        used.insert(images[i]->view);
        ExportedImage picture;
        picture.id = image.id;
        picture.camera_id = images[i]->view + 1;
        picture.name = images[i]->name;
        picture.cam_from_world = turned_pose(image.cam_from_world, view.quarter_turns);
        picture.cam_from_world.translation += picture.cam_from_world.rotation * origin;
        const Camera& camera = model.find_camera(image.camera_id)->camera;
        picture.keypoints.reserve(image.keypoints.size());
        for (const ExportedKeypoint& keypoint : image.keypoints) {
            const Eigen::Vector2d place = moved(keypoint, camera, view);
            picture.keypoints.push_back({place.x(), place.y(), keypoint.point});
        }
        result.images.push_back(std::move(picture));
    }
    for (const std::uint32_t view : used) result.cameras.push_back({view + 1, views[view].picture});

    std::set<std::uint64_t> dropped;
    result.points.reserve(model.points.size());
    for (const ExportedPoint& point : model.points) {
        ExportedPoint kept = point;
        std::erase_if(kept.track,
                      [&](const auto& seen) { return left_out.contains(seen.image_id); });
        if (kept.track.size() < 2) {
            dropped.insert(point.id);
            continue;
        }
        kept.position -= origin;
        result.points.push_back(std::move(kept));
    }
    const std::vector<std::size_t> distinct =
        distinct_points(result.points, Eigen::Vector3d::Zero());
    std::vector<ExportedPoint> points;
    points.reserve(distinct.size());
    for (std::size_t p = 0; p < result.points.size(); ++p) {
        if (points.size() < distinct.size() && distinct[points.size()] == p)
            points.push_back(std::move(result.points[p]));
        else
            dropped.insert(result.points[p].id);
    }
    result.points = std::move(points);
    if (dropped.empty()) return result;
    for (ExportedImage& image : result.images) {
        for (ExportedKeypoint& keypoint : image.keypoints) {
            if (dropped.contains(keypoint.point)) keypoint.point = kNoPoint;
        }
    }
    return result;
}

Eigen::Vector3d float_origin(const ExportedModel& model) {
    // Guard: sizes from the origin, where floats still tell 1e-5 of a size.
    constexpr double kFar = 100.0;
    if (model.images.empty()) return Eigen::Vector3d::Zero();
    std::vector<Eigen::Vector3d> centres;
    centres.reserve(model.images.size());
    for (const ExportedImage& image : model.images) {
        centres.push_back(image.cam_from_world.target_origin_in_source());
    }
    Eigen::Vector3d middle;
    Eigen::Vector3d low;
    Eigen::Vector3d high;
    for (int axis = 0; axis < 3; ++axis) {
        std::vector<double> values;
        values.reserve(centres.size());
        for (const Eigen::Vector3d& centre : centres) values.push_back(centre[axis]);
        std::ranges::sort(values);
        middle[axis] = values[values.size() / 2];
        low[axis] = values.front();
        high[axis] = values.back();
    }
    const double size = (high - low).norm();
    if (middle.norm() <= kFar * size) return Eigen::Vector3d::Zero();
    return middle.array().round();
}

}  // namespace psfm
