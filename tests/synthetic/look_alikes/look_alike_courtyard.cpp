// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "tests/synthetic/look_alikes/facade.h"
#include "tests/synthetic/look_alikes/look_alike_builder.h"
#include "tests/synthetic/look_alikes/look_alike_scene.h"
#include "tests/synthetic/rng.h"

namespace psfm::synthetic {
namespace {

constexpr double kLength = 60.0, kDepth = 44.0;  // of the court [m]
constexpr double kCornerRadius = 9.0;            // of the users' round [m]
constexpr double kEyeHeight = 1.7;               // [m]
/// A user covers this part of the round more than a fair share, so that users meet.
constexpr double kShareFactor = 2.2;

constexpr FacadeOptions kFacades{.height = 12.0,
                                 .relief = 1.2,
                                 .mean_range_deg = 25.0,
                                 .max_range_deg = 70.0,
                                 .nearest = 18.0,
                                 .farthest = 40.0};

/// Where somebody stands who has gone part of the round, and what is straight ahead inwards.
struct Stand {
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    double inward_rad = 0.0;  ///< angle from the x axis
};

/// A rectangle with round corners at `inset` from the walls.
/// @param part  of the round, any number
Stand stand_at(double part, double inset) {
    const double half_x = 0.5 * kLength - inset - kCornerRadius;
    const double half_y = 0.5 * kDepth - inset - kCornerRadius;
    const double arc = 0.5 * std::numbers::pi * kCornerRadius;
    const double round = 4.0 * (half_x + half_y + arc);
    double way = (part - std::floor(part)) * round;
    // From the middle of the side at +x, counter-clockwise: a straight, a corner, and so on.
    const std::array<double, 4> straights{2.0 * half_y, 2.0 * half_x, 2.0 * half_y, 2.0 * half_x};
    const std::array<Eigen::Vector2d, 4> corners{
        {{half_x, half_y}, {-half_x, half_y}, {-half_x, -half_y}, {half_x, -half_y}}};
    for (std::size_t side = 0;; side = (side + 1) % 4) {
        const double outward = 0.5 * std::numbers::pi * static_cast<double>(side);
        const Eigen::Vector2d normal(std::cos(outward), std::sin(outward));
        const Eigen::Vector2d along(-normal.y(), normal.x());
        if (way < straights[side] + arc) {
            const double turned = std::max(0.0, way - straights[side]) / kCornerRadius;
            const double back = std::max(0.0, straights[side] - way);
            const double angle = outward + turned;
            const Eigen::Vector2d at =
                corners[side] - back * along +
                kCornerRadius * Eigen::Vector2d(std::cos(angle), std::sin(angle));
            return {{at.x(), at.y(), kEyeHeight}, angle + std::numbers::pi};
        }
        way -= straights[side] + arc;
    }
}

/// The four facades; those across the court's length, of normals +x and -x, repeat.
std::vector<Facade> build_facades(const CourtyardOptions& options, LookAlikeBuilder& builder,
                                  Rng& rng) {
    FacadeOptions facade = kFacades;
    facade.points_per_metre = options.points_per_metre;
    facade.width = kDepth;
    const SharedDesign shared = share(draw_facade(facade, options.repeated_part, rng), builder);
    std::vector<Facade> facades;
    for (int side = 0; side < 4; ++side) {
        const double angle = 0.5 * std::numbers::pi * side;
        const Eigen::Vector3d outward(std::round(std::cos(angle)), std::round(std::sin(angle)),
                                      0.0);
        const bool repeats = side % 2 == 0;
        facade.width = repeats ? kDepth : kLength;
        const double off = 0.5 * (repeats ? kLength : kDepth);
        const FacadeDesign own =
            draw_facade(facade, repeats ? 1.0 - options.repeated_part : 1.0, rng);
        facades.push_back(build_facade(facade, world_from_facade(off * outward, -outward), own,
                                       repeats ? &shared : nullptr, builder));
    }
    return facades;
}

std::array<Camera, 3> make_cameras() {
    Camera pinhole = make_camera(900, 675, 704.5, FocalSource::kGiven);
    pinhole.model = CameraModel::kPinhole;
    pinhole.params = {704.5, 704.5, 450.0, 337.5};
    Camera wide = make_camera(1000, 667, 661.0, FocalSource::kGiven);
    wide.params[3] = -0.05;
    return {pinhole, wide, make_camera(800, 600, 784.0, FocalSource::kGiven)};
}

}  // namespace

Result<void> validate(const CourtyardOptions& options) {
    const auto invalid = [](const char* what) { return Error{ErrorCode::kInvalidArgument, what}; };
    if (options.images < 2 || options.images > 20000) {
        return invalid("a courtyard takes 2 to 20000 images");
    }
    if (options.users < 1 || options.users > std::min(options.images, 99U)) {
        return invalid("users must be in 1 ... 99, and not more than images");
    }
    if (!(options.points_per_metre > 0.0) || options.points_per_metre > 5000.0) {
        return invalid("points a metre must be above 0 and at most 5000");
    }
    if (!(options.repeated_part >= 0.0) || options.repeated_part > 1.0) {
        return invalid("the repeated part must be in 0 ... 1");
    }
    if (!(options.noise_px >= 0.0) || options.noise_px > 10.0) {
        return invalid("noise must be in 0 ... 10 pixels");
    }
    return {};
}

LookAlikeScene make_courtyard(const CourtyardOptions& options, std::uint64_t seed) {
    LookAlikeBuilder builder(seed);
    Rng facade_rng(mix_seed(seed, 34));
    const std::vector<Facade> facades = build_facades(options, builder, facade_rng);
    for (const Camera& camera : make_cameras()) builder.add_camera(camera);

    std::vector<std::uint32_t> images_of_user;
    for (std::uint32_t user = 0; user < options.users; ++user) {
        Rng rng(mix_seed(mix_seed(seed, 35), user));
        const std::uint32_t count =
            (options.images * (user + 1)) / options.users - (options.images * user) / options.users;
        images_of_user.push_back(count);
        const double inset = rng.uniform(3.0, 6.0);
        const double begin = (user + rng.uniform(-0.1, 0.1)) / options.users;
        const double length = std::min(1.0, kShareFactor / options.users);
        const double direction = user % 2 == 0 ? 1.0 : -1.0;
        const double sway_phase = rng.uniform(0.0, 2.0 * std::numbers::pi);
        const std::string digits = std::to_string(user + 1);
        const std::string name =
            "user" + std::string(options.users > 9 && digits.size() < 2 ? "0" : "") + digits;
        for (std::uint32_t i = 0; i < count; ++i) {
            const double progress = direction * length * ((i + 0.5) / count - 0.5);
            const Stand stand = stand_at(begin + progress, inset);
            const Eigen::Vector3d centre = stand.position + 0.05 * rng.normal3();
            const double sway = 0.25 * std::sin(12.0 * progress + sway_phase);
            const double yaw = stand.inward_rad + sway + 0.02 * rng.normal();
            const double pitch = 0.1 + 0.02 * rng.normal();
            const Eigen::Vector3d ahead(std::cos(yaw), std::sin(yaw), pitch);
            const ImageId image = builder.add_image(
                CameraId{user % 3}, look_at(centre, centre + ahead), image_name(name, i, count));
            for (const Facade& facade : facades) {
                observe_facade(facade, image, centre, {}, builder);
            }
        }
    }
    LookAlikeScene made = builder.finish(options.noise_px);
    made.order = interleaved_order(images_of_user, seed);
    return made;
}

}  // namespace psfm::synthetic
