// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <GeographicLib/LocalCartesian.hpp>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "stages/algorithms/math/angles.h"
#include "tests/synthetic/photographs/render.h"
#include "tests/synthetic/rng.h"
#include "tests/synthetic/scene.h"

namespace psfm::synthetic {
namespace {

Camera plan_camera(const PhotoSetOptions& options) {
    const std::uint32_t long_side = std::max(options.width, options.height);
    const double exif_px = options.focal_35mm / 36.0 * long_side;
    Camera camera =
        make_camera(options.width, options.height, exif_px * (1.0 + options.focal_relative_error),
                    FocalSource::kGiven);
    const double f = camera.params[0];
    const double cx = camera.params[1];
    const double cy = camera.params[2];
    camera.model = options.model;
    switch (options.model) {
        case CameraModel::kSimplePinhole:
            camera.params = {f, cx, cy};
            break;
        case CameraModel::kPinhole:
            camera.params = {f, f, cx, cy};
            break;
        case CameraModel::kSimpleRadial:
        case CameraModel::kRadial:
            camera.params = {f, cx, cy, options.k1};
            break;
        case CameraModel::kOpenCv:
            camera.params = {f, f, cx, cy, options.k1};
            break;
    }
    return camera;
}

/// As a person who walks about with a camera would: nearly even steps, never quite level.
Rigid3 plan_pose(const PhotoSetOptions& options, std::uint32_t i, Rng& rng) {
    Eigen::Vector3d centre;
    Eigen::Vector3d target;
    const double height = 1.6 + rng.uniform(-0.15, 0.15);
    if (options.scene == PhotoScene::kCourtyard) {
        const double angle =
            2.0 * std::numbers::pi * (i + rng.uniform(-0.15, 0.15)) / options.images;
        const double radius = 5.4 + rng.uniform(-0.25, 0.25);
        centre = {radius * std::cos(angle), radius * std::sin(angle), height};
        target = {rng.uniform(-0.3, 0.3), rng.uniform(-0.3, 0.3), 1.2 + rng.uniform(-0.1, 0.1)};
    } else {
        const double part =
            options.images == 1 ? 0.5 : static_cast<double>(i) / (options.images - 1);
        const double x = 7.0 * (part - 0.5) + rng.uniform(-0.1, 0.1);
        centre = {x, -5.0 + rng.uniform(-0.3, 0.3), height};
        target = {0.8 * x + rng.uniform(-0.2, 0.2), 0.0, 1.6 + rng.uniform(-0.1, 0.1)};
    }
    Rigid3 pose = look_at(centre, target);
    const Eigen::AngleAxisd roll(radians_from_degrees(rng.uniform(-2.0, 2.0)),
                                 Eigen::Vector3d::UnitZ());
    pose.rotation = (roll * pose.rotation).normalized();
    pose.translation = -(pose.rotation * centre);
    return pose;
}

/// The camera rolled so that what EXIF's orientation 6 (8) undoes is a photograph that stands
/// upright: the stored image's left (right) side was up.
Rigid3 rolled(const Rigid3& cam_from_world, std::uint8_t orientation) {
    const double angle = orientation == 6 ? -90.0 : 90.0;
    const Eigen::AngleAxisd roll(radians_from_degrees(angle), Eigen::Vector3d::UnitZ());
    return Rigid3{Eigen::Quaterniond(roll), Eigen::Vector3d::Zero()} * cam_from_world;
}

GpsPosition measure_gps(const GpsOptions& options, const Eigen::Vector3d& centre, Rng& rng) {
    const GeographicLib::LocalCartesian local(options.origin.latitude_deg,
                                              options.origin.longitude_deg,
                                              options.origin.altitude_m.value_or(0.0));
    const Eigen::Vector3d measured = centre + options.sigma * rng.normal3();
    GpsPosition position;
    double altitude = 0.0;
    local.Reverse(measured.x(), measured.y(), measured.z(), position.latitude_deg,
                  position.longitude_deg, altitude);
    position.altitude_m = altitude;
    return position;
}

}  // namespace

Result<void> validate(const PhotoSetOptions& options) {
    const auto invalid = [](const char* what) { return Error{ErrorCode::kInvalidArgument, what}; };
    if (options.images == 0 || options.images > 9999) return invalid("images must be in 1 … 9999");
    if (options.width < 16 || options.height < 16 || options.width > 16384 ||
        options.height > 16384) {
        return invalid("width and height must be in 16 … 16384 px");
    }
    if (!(options.texels_per_metre >= 10.0) || options.texels_per_metre > 1000.0) {
        return invalid("texels_per_metre must be in 10 … 1000");
    }
    if (options.focal_35mm < 10 || options.focal_35mm > 500) {
        return invalid("focal_35mm must be in 10 … 500 mm");
    }
    if (!(std::abs(options.focal_relative_error) <= 0.5)) {
        return invalid("focal_relative_error must be within 0.5");
    }
    if (options.portrait_every && *options.portrait_every == 0) {
        return invalid("portrait_every must be above 0");
    }
    if (options.jpeg_quality < 1 || options.jpeg_quality > 100) {
        return invalid("jpeg_quality must be in 1 … 100");
    }
    return validate(plan_camera(options));
}

PhotoPlan plan_photographs(const PhotoSetOptions& options, std::uint64_t seed) {
    Rng rng(mix_seed(seed, 43));
    PhotoPlan plan{.camera = plan_camera(options), .photos = {}};
    for (std::uint32_t i = 0; i < options.images; ++i) {
        PlannedPhoto photo;
        std::array<char, 32> name{};
        std::snprintf(name.data(), name.size(), "photo_%04u.jpg", i);
        photo.name = name.data();
        photo.cam_from_world = plan_pose(options, i, rng);
        if (options.portrait_every && i % *options.portrait_every == 0) {
            photo.orientation = i / *options.portrait_every % 2 == 0 ? 6 : 8;
            photo.cam_from_world = rolled(photo.cam_from_world, photo.orientation);
        }
        if (options.gps) {
            photo.gps =
                measure_gps(*options.gps, photo.cam_from_world.target_origin_in_source(), rng);
        }
        plan.photos.push_back(std::move(photo));
    }
    return plan;
}

}  // namespace psfm::synthetic
