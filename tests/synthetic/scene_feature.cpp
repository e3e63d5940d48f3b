// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/synthetic/scene_feature.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/synthetic/rng.h"

namespace psfm::synthetic {
namespace {

Keypoint make_keypoint(const Eigen::Vector2d& pixel, double pixels_per_metre,
                       std::uint64_t point_seed) {
    Keypoint keypoint;
    keypoint.x = static_cast<float>(pixel.x());
    keypoint.y = static_cast<float>(pixel.y());
    // Blobs of 5 to 50 mm.
    const double size = 0.005 * std::pow(10.0, chance(point_seed, 0));
    keypoint.scale = static_cast<float>(size * pixels_per_metre);
    keypoint.angle = static_cast<float>(2.0 * std::numbers::pi * chance(point_seed, 1));
    const std::uint64_t colour = mix_seed(point_seed, 2);
    keypoint.red = static_cast<std::uint8_t>(colour);
    keypoint.green = static_cast<std::uint8_t>(colour >> 8U);
    keypoint.blue = static_cast<std::uint8_t>(colour >> 16U);
    return keypoint;
}

}  // namespace

double chance(std::uint64_t seed, std::uint64_t value) {
    return static_cast<double>(mix_seed(seed, value) >> 11U) * 0x1.0p-53;
}

double field_of_view(const Camera& camera) {
    double radius = 0.0;
    const double w = camera.width;
    const double h = camera.height;
    for (const Eigen::Vector2d& corner : {Eigen::Vector2d(0, 0), Eigen::Vector2d(w, 0),
                                          Eigen::Vector2d(0, h), Eigen::Vector2d(w, h)}) {
        radius = std::max(radius, normalized_from_pixel(camera, corner).norm());
    }
    return radius;
}

std::optional<Keypoint> feature_of(const Camera& camera, double limit, const Rigid3& cam_from_world,
                                   const Eigen::Vector3d& position, std::uint64_t point_seed) {
    const Eigen::Vector3d in_cam = cam_from_world * position;
    if (in_cam.z() <= 0.0 || in_cam.head<2>().norm() > limit * in_cam.z()) return std::nullopt;
    const std::optional<Eigen::Vector2d> pixel = project(camera, in_cam);
    if (!pixel || pixel->minCoeff() < 0.0 || pixel->x() >= camera.width ||
        pixel->y() >= camera.height) {
        return std::nullopt;
    }
    return make_keypoint(*pixel, camera.mean_focal() / in_cam.z(), point_seed);
}

}  // namespace psfm::synthetic
