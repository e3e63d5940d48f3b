// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/synthetic/look_alikes/look_alike_builder.h"
#include "tests/synthetic/look_alikes/look_alike_scene.h"
#include "tests/synthetic/rng.h"

namespace psfm::synthetic {
namespace {

constexpr double kRingRadius = 47.0;  // [m]; these as temple-341 has them
constexpr double kCameraHeight = 3.0, kAimHeight = 8.0;
constexpr double kRadiusSigma = 0.3, kHeightSigma = 0.15, kAngleSigmaDeg = 0.1, kTurnSigmaDeg = 1.0;
constexpr double kTiers = 3, kTierHeight = 6.0;  // narrower from tier to tier, as pagodas are
constexpr double kBaseRadius = 15.0, kTierStep = 3.0, kRelief = 0.3;
/// Cameras this far round from a point have it in view from the side.
constexpr double kLimbDeg = 60.0;

double radians(double degrees) {
    return degrees * std::numbers::pi / 180.0;
}

/// How many points of a kind there are, and how far they can be followed.
struct Layer {
    double mean_deg;
    double features;  ///< an image has on average, but for the cut at max_deg
};

/// A point on the building and the ring's angles that it is detected from [deg].
struct TemplePoint {
    double azimuth_deg, from_deg, to_deg;
    double radius, height;
};

/// Points whose range of view has its middle in [0, sector_deg).
TemplePoint draw_point(Rng& rng, double mean_deg, double max_deg, double sector_deg) {
    const double range_deg = std::min(-mean_deg * std::log(1.0 - rng.uniform()), max_deg);
    const double middle_deg = rng.uniform(0.0, sector_deg);
    const double side_deg = std::max(0.0, kLimbDeg - 0.5 * range_deg);
    TemplePoint point{};
    point.azimuth_deg = middle_deg + rng.uniform(-side_deg, side_deg);
    point.from_deg = middle_deg - 0.5 * range_deg;
    point.to_deg = middle_deg + 0.5 * range_deg;
    point.height = rng.uniform(0.0, kTiers * kTierHeight);
    point.radius =
        kBaseRadius - kTierStep * std::floor(point.height / kTierHeight) + kRelief * rng.normal();
    return point;
}

SurfacePoint on_surface(const TemplePoint& point, double turn_deg) {
    const double angle = radians(point.azimuth_deg + turn_deg);
    const Eigen::Vector3d normal(std::cos(angle), std::sin(angle), 0.0);
    return {point.radius * normal + Eigen::Vector3d(0, 0, point.height), normal};
}

class Temple {
  public:
    Temple(const TempleOptions& options, std::uint64_t seed)
        : options_(options), builder_(seed), seed_(seed) {
        const double side_deg = 360.0 / options.symmetry;
        for (std::uint32_t side = 0; side < options.symmetry; ++side) {
            Rigid3 world_from_side;
            world_from_side.rotation =
                Eigen::AngleAxisd(radians(side_deg * side), Eigen::Vector3d::UnitZ());
            builder_.add_place(world_from_side);
        }
        add_cameras();
    }

    LookAlikeScene make() {
        const Layer lasting{options_.lasting_deg, options_.lasting_features};
        const Layer brief{options_.brief_deg, options_.brief_features};
        add_points(lasting, options_.repeated_part, 31);
        add_points(brief, 0.0, 32);
        LookAlikeScene made = builder_.finish(options_.noise_px);
        made.order = unfortunate_order();
        return made;
    }

  private:
    void add_cameras() {
        Rng rng(mix_seed(seed_, 33));
        const Camera camera = make_camera(864, 648, 843.2, FocalSource::kGiven);
        const CameraId id = builder_.add_camera(camera);
        const std::uint32_t count = options_.images;
        for (std::uint32_t i = 0; i < count; ++i) {
            const double angle_deg = 360.0 * i / count;
            const double jitter_deg =
                std::clamp(kAngleSigmaDeg * rng.normal(), -90.0 / count, 90.0 / count);
            const double angle = radians(angle_deg + jitter_deg);
            const double radius = kRingRadius + kRadiusSigma * rng.normal();
            const double height = kCameraHeight + kHeightSigma * rng.normal();
            const Eigen::Vector3d centre(radius * std::cos(angle), radius * std::sin(angle),
                                         height);
            Rigid3 pose = look_at(centre, {0.0, 0.0, kAimHeight});
            Rigid3 turn;
            turn.rotation = rng.small_rotation(radians(kTurnSigmaDeg));
            pose = turn * pose;
            builder_.add_image(id, pose, image_name("temple", i, count));
            angle_deg_.push_back(angle_deg + jitter_deg);
        }
    }

    void add_points(const Layer& layer, double repeated_part, std::uint64_t kind) {
        Rng rng(mix_seed(seed_, kind));
        // An image sees features / mean points for each degree that their ranges' middles lie in.
        const double per_degree = layer.features / layer.mean_deg;
        const double side_deg = 360.0 / options_.symmetry;
        const auto looks_a_side = std::llround(per_degree * side_deg * repeated_part);
        for (auto i = looks_a_side; i > 0; --i) {
            const TemplePoint point = draw_point(rng, layer.mean_deg, options_.max_deg, side_deg);
            const std::uint32_t look = builder_.add_look();
            for (std::uint32_t side = 0; side < options_.symmetry; ++side) {
                add_point(point, side_deg * side, look, side);
            }
        }
        const auto unique = std::llround(per_degree * 360.0 * (1.0 - repeated_part));
        for (auto i = unique; i > 0; --i) {
            const TemplePoint point = draw_point(rng, layer.mean_deg, options_.max_deg, 360.0);
            add_point(point, 0.0, builder_.add_look(), kNoPlace);
        }
    }

    void add_point(const TemplePoint& point, double turn_deg, std::uint32_t look,
                   std::uint32_t place) {
        const std::uint32_t index = builder_.add_point(on_surface(point, turn_deg), look, place);
        // Cameras are evenly spaced up to less than half a step either way.
        const double step_deg = 360.0 / options_.images;
        const double from_deg = point.from_deg + turn_deg;
        const double to_deg = point.to_deg + turn_deg;
        const auto last = static_cast<std::int64_t>(std::ceil(to_deg / step_deg + 0.5));
        for (auto i = static_cast<std::int64_t>(std::floor(from_deg / step_deg - 0.5)); i <= last;
             ++i) {
            const auto count = static_cast<std::int64_t>(options_.images);
            const auto image = static_cast<std::uint32_t>(((i % count) + count) % count);
            const double turns_deg = step_deg * static_cast<double>(i - image);
            const double angle_deg = angle_deg_[image] + turns_deg;
            if (angle_deg >= from_deg && angle_deg <= to_deg)
                builder_.observe(ImageId{image}, index);
        }
    }

    std::vector<std::size_t> unfortunate_order() const {
        const std::size_t count = options_.images;
        const auto step =
            static_cast<std::size_t>(std::llround(static_cast<double>(count) / options_.symmetry));
        std::vector<std::size_t> order;
        std::vector<bool> arrived(count, false);
        for (std::size_t i = 0; i < count; ++i) {
            for (const std::size_t image : {i, (i + step) % count}) {
                if (!arrived[image]) order.push_back(image);
                arrived[image] = true;
            }
        }
        return order;
    }

    TempleOptions options_;
    LookAlikeBuilder builder_;
    std::uint64_t seed_;
    std::vector<double> angle_deg_;  ///< of each camera
};

}  // namespace

Result<void> validate(const TempleOptions& options) {
    const auto invalid = [](const char* what) { return Error{ErrorCode::kInvalidArgument, what}; };
    if (options.images < 2 || options.images > 20000) {
        return invalid("a temple takes 2 to 20000 images");
    }
    if (options.symmetry < 1 || options.symmetry > 36) {
        return invalid("the temple's symmetry must be in 1 ... 36");
    }
    if (!(options.lasting_features >= 0.0) || !(options.brief_features >= 0.0) ||
        options.lasting_features + options.brief_features > 10000.0) {
        return invalid("features an image must be at least 0 and at most 10000 in all");
    }
    if (!(options.lasting_deg >= 0.1) || !(options.brief_deg >= 0.1) ||
        !(options.max_deg <= 2.0 * kLimbDeg) || !(options.max_deg >= 1.0)) {
        return invalid("features must last for 0.1 degrees or more, and at most for 120");
    }
    if (!(options.repeated_part >= 0.0) || options.repeated_part > 1.0) {
        return invalid("the repeated part must be in 0 ... 1");
    }
    if (!(options.noise_px >= 0.0) || options.noise_px > 10.0) {
        return invalid("noise must be in 0 ... 10 pixels");
    }
    return {};
}

LookAlikeScene make_temple(const TempleOptions& options, std::uint64_t seed) {
    return Temple(options, seed).make();
}

}  // namespace psfm::synthetic
