// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/synthetic/scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/synthetic/photographs/camera_path.h"
#include "tests/synthetic/point_grid.h"
#include "tests/synthetic/rng.h"
#include "tests/synthetic/scene_feature.h"

namespace psfm::synthetic {
namespace {

bool faces(const SurfacePoint& point, const Eigen::Vector3d& centre,
           const VisibilityOptions& options, double min_cosine) {
    const Eigen::Vector3d to_camera = centre - point.position;
    const double distance = to_camera.norm();
    return distance > 0.0 && distance <= options.max_distance &&
           to_camera.dot(point.normal) >= min_cosine * distance;
}

void observe(const SyntheticScene& scene, const PointGrid& grid, const VisibilityOptions& options,
             std::uint64_t image_seed, SceneImage& image) {
    const Camera& camera = scene.cameras.at(image.camera);
    const Eigen::Vector3d centre = image.cam_from_world.target_origin_in_source();
    const double limit = field_of_view(camera);
    const double min_cosine = std::cos(options.max_normal_angle_deg * std::numbers::pi / 180.0);
    std::vector<std::pair<Keypoint, std::uint32_t>> seen;
    for (const std::uint32_t index : grid.near(centre, options.max_distance)) {
        if (options.max_features && seen.size() >= *options.max_features) break;
        const SurfacePoint& point = scene.points[index];
        if (!faces(point, centre, options, min_cosine)) continue;
        const std::optional<Keypoint> feature = feature_of(
            camera, limit, image.cam_from_world, point.position, mix_seed(scene.seed, index));
        if (!feature || chance(image_seed, index) >= options.detection_rate) continue;
        seen.emplace_back(*feature, index);
    }
    std::ranges::stable_sort(seen, std::ranges::greater{},
                             [](const auto& feature) { return feature.first.scale; });
    for (const auto& [keypoint, index] : seen) {
        image.keypoints.push_back(keypoint);
        image.feature_point.push_back(index);
    }
}

}  // namespace

Result<void> validate(const SceneOptions& options) {
    const auto invalid = [](const char* what) { return Error{ErrorCode::kInvalidArgument, what}; };
    const PointOptions& points = options.points;
    const CameraOptions& cameras = options.cameras;
    const VisibilityOptions& visibility = options.visibility;
    if (points.count == 0 || cameras.count == 0) return invalid("a scene needs points and cameras");
    if (!(points.extent.minCoeff() > 0.0) || !(points.relief >= 0.0)) {
        return invalid("extent must be above 0 and relief at least 0");
    }
    if (!(cameras.radius >= 0.0) || !(cameras.arc_deg > 0.0) || cameras.arc_deg > 360.0) {
        return invalid("radius must be at least 0 and arc_deg in (0, 360]");
    }
    if (cameras.path == Path::kRandom && cameras.distance < cameras.radius) {
        return invalid("kRandom needs distance at least radius");
    }
    if (!(cameras.turn_sigma_deg >= 0.0) || !(cameras.shift_sigma >= 0.0)) {
        return invalid("turn_sigma_deg and shift_sigma must be at least 0");
    }
    if (!(visibility.max_distance > 0.0) || !(visibility.max_normal_angle_deg > 0.0) ||
        visibility.max_normal_angle_deg > 180.0) {
        return invalid("max_distance must be above 0 and max_normal_angle_deg in (0, 180]");
    }
    if (!(visibility.detection_rate > 0.0) || visibility.detection_rate > 1.0) {
        return invalid("detection_rate must be in (0, 1]");
    }
    return validate(make_true_camera(cameras, 1.0));
}

SyntheticScene make_scene(const SceneOptions& options, std::uint64_t seed) {
    SyntheticScene scene;
    scene.seed = seed;
    scene.points = make_points(options.points, seed);
    const PointGrid grid(scene.points, 0.5 * options.visibility.max_distance);
    const std::vector<Rigid3> poses = make_poses(options.cameras, seed);
    const std::uint64_t focal_seed = mix_seed(seed, 3);
    const std::uint64_t detection_seed = mix_seed(seed, 4);
    for (std::uint32_t i = 0; i < poses.size(); ++i) {
        const auto camera = static_cast<CameraId>(options.cameras.shared ? 0 : i);
        const double factor = options.cameras.shared ? 1.0 : 0.95 + 0.1 * chance(focal_seed, i);
        scene.cameras.try_emplace(camera, make_true_camera(options.cameras, factor));
        SceneImage image;
        image.camera = camera;
        image.cam_from_world = poses[i];
        observe(scene, grid, options.visibility, mix_seed(detection_seed, i), image);
        scene.images.push_back(std::move(image));
    }
    return scene;
}

SceneOptions ring_around_sphere(std::uint32_t images) {
    SceneOptions options;
    options.cameras.count = images;
    return options;
}

SceneOptions line_along_wall(std::uint32_t images) {
    // Two thirds of a view are shared with each neighbour, whatever the number of images.
    SceneOptions options;
    const double half = 1.0 * images;
    options.points = {.surface = Surface::kReliefWall,
                      .count = 250 * (images + 4),
                      .extent = {2.0 * half + 8.0, 1.0, 6.0},
                      .relief = 0.5};
    options.cameras.path = Path::kLine;
    options.cameras.count = images;
    options.cameras.radius = half;
    options.cameras.distance = 6.0;
    options.visibility.max_distance = 15.0;
    return options;
}

SceneOptions grid_over_ground(std::uint32_t images) {
    SceneOptions options;
    const double half = 1.5 * std::sqrt(images);
    const double width = 2.0 * half + 8.0;
    options.points = {.surface = Surface::kGround,
                      .count = static_cast<std::uint32_t>(12.0 * width * width),
                      .extent = {width, width, 1.0},
                      .relief = 0.8};
    options.cameras.path = Path::kGrid;
    options.cameras.count = images;
    options.cameras.radius = half;
    options.cameras.height = 9.0;
    options.visibility.max_distance = 20.0;
    return options;
}

SceneOptions ring_in_room(std::uint32_t images) {
    SceneOptions options;
    options.points = {.surface = Surface::kBoxRoom, .count = 5000, .extent = {12.0, 12.0, 4.0}};
    options.cameras.count = images;
    options.cameras.radius = 3.0;
    options.cameras.outward = true;
    return options;
}

SyntheticScene reorder_images(const SyntheticScene& scene, std::span<const std::size_t> order) {
    SyntheticScene result = scene;
    for (std::size_t i = 0; i < order.size(); ++i) result.images[i] = scene.images.at(order[i]);
    return result;
}

std::vector<std::vector<Observation>> tracks(const SyntheticScene& scene) {
    std::vector<std::vector<Observation>> result(scene.points.size());
    for (std::uint32_t i = 0; i < scene.images.size(); ++i) {
        const std::vector<std::uint32_t>& points = scene.images[i].feature_point;
        for (std::uint32_t feature = 0; feature < points.size(); ++feature) {
            if (points[feature] == kNoPoint) continue;
            result[points[feature]].push_back({static_cast<ImageId>(i), feature});
        }
    }
    return result;
}

}  // namespace psfm::synthetic
