// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/synthetic/photographs/camera_path.h"

#include <cmath>

#include "stages/algorithms/math/angles.h"
#include "tests/synthetic/rng.h"

namespace psfm::synthetic {
namespace {

Rigid3 on_ring(const CameraOptions& options, std::uint32_t i) {
    // A whole circle ends where it began, an arc has a camera at either end.
    const bool closed = options.arc_deg >= 360.0;
    const double steps = closed || options.count == 1 ? options.count : options.count - 1;
    const double angle = radians_from_degrees(options.arc_deg) * i / steps;
    const Eigen::Vector3d away(std::cos(angle), std::sin(angle), 0.0);
    const Eigen::Vector3d centre =
        options.radius * away + options.height * Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d level = (options.outward ? 1.0 : -1.0) * away;
    // Inward cameras look at the origin, whatever their height; outward ones at the horizon.
    const bool at_origin = !options.outward && options.radius > 0.0;
    return look_at(centre, at_origin ? Eigen::Vector3d::Zero() : Eigen::Vector3d(centre + level));
}

Rigid3 on_line(const CameraOptions& options, std::uint32_t i) {
    const double part = options.count == 1 ? 0.5 : static_cast<double>(i) / (options.count - 1);
    const Eigen::Vector3d centre(options.radius * (2.0 * part - 1.0), -options.distance,
                                 options.height);
    return look_at(centre, centre + Eigen::Vector3d::UnitY());
}

Rigid3 on_grid(const CameraOptions& options, std::uint32_t i) {
    const auto columns = static_cast<std::uint32_t>(std::ceil(std::sqrt(options.count)));
    const std::uint32_t rows = (options.count + columns - 1) / columns;
    const auto coordinate = [&](std::uint32_t k, std::uint32_t n) {
        return n == 1 ? 0.0 : options.radius * (2.0 * k / (n - 1.0) - 1.0);
    };
    const Eigen::Vector3d centre(coordinate(i % columns, columns), coordinate(i / columns, rows),
                                 options.height);
    return look_at(centre, centre - Eigen::Vector3d::UnitZ());
}

}  // namespace

Rigid3 look_at(const Eigen::Vector3d& centre, const Eigen::Vector3d& target) {
    const Eigen::Vector3d forward = (target - centre).normalized();
    const bool vertical = std::abs(forward.z()) > 1.0 - 1e-9;
    const Eigen::Vector3d up = vertical ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d right = forward.cross(up).normalized();
    Eigen::Matrix3d cam_from_world;
    cam_from_world << right.transpose(), forward.cross(right).transpose(), forward.transpose();
    Rigid3 pose;
    pose.rotation = Eigen::Quaterniond(cam_from_world).normalized();
    pose.translation = -(pose.rotation * centre);
    return pose;
}

std::vector<Rigid3> make_poses(const CameraOptions& options, std::uint64_t seed) {
    Rng rng(mix_seed(seed, 2));
    std::vector<Rigid3> poses;
    for (std::uint32_t i = 0; i < options.count; ++i) {
        Rigid3 pose;
        switch (options.path) {
            case Path::kRing:
                pose = on_ring(options, i);
                break;
            case Path::kLine:
                pose = on_line(options, i);
                break;
            case Path::kGrid:
                pose = on_grid(options, i);
                break;
            case Path::kRandom: {
                const double range = rng.uniform(options.radius, options.distance);
                const Eigen::Vector3d centre = range * rng.direction();
                pose = look_at(centre, 0.1 * options.radius * rng.normal3());
                break;
            }
        }
        const Eigen::Vector3d centre =
            pose.target_origin_in_source() + options.shift_sigma * rng.normal3();
        pose.rotation =
            rng.small_rotation(radians_from_degrees(options.turn_sigma_deg)) * pose.rotation;
        pose.translation = -(pose.rotation * centre);
        poses.push_back(pose);
    }
    return poses;
}

Camera make_true_camera(const CameraOptions& options, double focal_factor) {
    const double f = focal_factor * options.focal_px;
    const double fy = f * options.aspect;
    const double cx = 0.5 * options.width;
    const double cy = 0.5 * options.height_px;
    Camera camera;
    camera.model = options.model;
    camera.width = options.width;
    camera.height = options.height_px;
    camera.focal_source = FocalSource::kGiven;
    switch (options.model) {
        case CameraModel::kSimplePinhole:
            camera.params = {f, cx, cy};
            break;
        case CameraModel::kPinhole:
            camera.params = {f, fy, cx, cy};
            break;
        case CameraModel::kSimpleRadial:
            camera.params = {f, cx, cy, options.k1};
            break;
        case CameraModel::kRadial:
            camera.params = {f, cx, cy, options.k1, options.k2};
            break;
        case CameraModel::kOpenCv:
            camera.params = {f, fy, cx, cy, options.k1, options.k2, options.p1, options.p2};
            break;
    }
    return camera;
}

}  // namespace psfm::synthetic
