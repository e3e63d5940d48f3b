// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "tests/stages/reconstruction/problems.h"
#include "tests/synthetic/disturb.h"
#include "tests/synthetic/scene.h"
#include "tests/synthetic/verified_pairs.h"

// Photographs without EXIF: a camera each, as a session accepts them, though one camera took them.

namespace psfm {

/// Each image with a camera of its own, all alike.
inline synthetic::SyntheticScene with_own_cameras(synthetic::SyntheticScene scene) {
    const std::map<CameraId, Camera> shared = scene.cameras;
    scene.cameras.clear();
    for (std::size_t i = 0; i < scene.images.size(); ++i) {
        const auto own = static_cast<CameraId>(i);
        scene.cameras[own] = shared.at(scene.images[i].camera);
        scene.images[i].camera = own;
    }
    return scene;
}

inline void keep_inside(const Camera& camera, synthetic::SceneImage& image) {
    Keypoints keypoints;
    std::vector<std::uint32_t> points;
    for (std::size_t k = 0; k < image.keypoints.size(); ++k) {
        const Keypoint& keypoint = image.keypoints[k];
        const bool inside = keypoint.x >= 0 && keypoint.y >= 0 &&
                            keypoint.x < static_cast<float>(camera.width) &&
                            keypoint.y < static_cast<float>(camera.height);
        if (!inside) continue;
        keypoints.push_back(keypoint);
        points.push_back(image.feature_point[k]);
    }
    image.keypoints = std::move(keypoints);
    image.feature_point = std::move(points);
}

/// The middle of an image enlarged to its size. REQUIRES: cameras of one image each
inline void zoom(synthetic::SyntheticScene& scene, std::size_t number, double factor) {
    synthetic::SceneImage& image = scene.images[number];
    Camera& camera = scene.cameras.at(image.camera);
    const Eigen::Vector2d centre = camera.principal_point();
    camera.params[0] *= factor;
    for (Keypoint& keypoint : image.keypoints) {
        const Eigen::Vector2d moved = centre + factor * (keypoint.position() - centre);
        keypoint.x = static_cast<float>(moved.x());
        keypoint.y = static_cast<float>(moved.y());
    }
    keep_inside(camera, image);
}

/// The camera turned by a right angle about its axis. REQUIRES: as above
inline void turn(synthetic::SyntheticScene& scene, std::size_t number) {
    synthetic::SceneImage& image = scene.images[number];
    Camera& camera = scene.cameras.at(image.camera);
    const auto width = static_cast<float>(camera.width);
    for (Keypoint& keypoint : image.keypoints)
        keypoint = {keypoint.y, width - keypoint.x, keypoint.scale, keypoint.angle};
    Eigen::Matrix3d rotation;
    rotation << 0, 1, 0, -1, 0, 0, 0, 0, 1;
    const Rigid3 turned{Eigen::Quaterniond(rotation), Eigen::Vector3d::Zero()};
    image.cam_from_world = turned * image.cam_from_world;
    std::swap(camera.width, camera.height);
    std::swap(camera.params[1], camera.params[2]);
    camera.params[2] = width - camera.params[2];
}

/// The scene as a session without EXIF would pose it. REQUIRES: as above
inline ClusterProblem problem_without_exif(const synthetic::SyntheticScene& scene,
                                           std::size_t image_count) {
    std::map<CameraId, Camera> unknown;
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> kinds;
    ClusterProblem problem;
    for (const auto& [id, camera] : scene.cameras) {
        const auto longer = std::max(camera.width, camera.height);
        unknown[id] = make_camera(camera.width, camera.height, 1.2 * longer, FocalSource::kUnknown);
    }
    problem = problem_of(scene, synthetic::make_verified_pairs(scene, {.calibrated = false}),
                         unknown, image_count);
    for (const auto& [id, camera] : unknown) {
        if (index_of(id) >= image_count) continue;
        const auto number = static_cast<std::uint32_t>(kinds.size());
        const auto size = std::minmax(camera.width, camera.height);
        problem.alike[id] = kinds.try_emplace(size, number).first->second;
    }
    std::erase_if(problem.cameras, [&](const auto& c) { return index_of(c.first) >= image_count; });
    return problem;
}

inline ClusterProblem problem_without_exif(const synthetic::SyntheticScene& scene) {
    return problem_without_exif(scene, scene.images.size());
}

}  // namespace psfm
