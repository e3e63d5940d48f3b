// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "tests/synthetic/look_alikes/facade.h"
#include "tests/synthetic/look_alikes/look_alike_builder.h"
#include "tests/synthetic/look_alikes/look_alike_scene.h"
#include "tests/synthetic/look_alikes/town.h"
#include "tests/synthetic/rng.h"

namespace psfm::synthetic {
namespace {

constexpr double kWalkerHeight = 1.7;  // [m]
/// Images are about this far apart [m], each street is walked this often: so an image overlaps some
/// tens of others.
constexpr double kStep = 1.0;
constexpr std::uint32_t kMaxWalks = 4;
/// The look goes from one side to the other and back once in this way [m], almost to right angles.
constexpr double kPanPeriod = 60.0, kPanRad = 1.45;
/// Of order_by_district; with 10,000 images each is 15 m of 310 m wide.
constexpr std::uint32_t kDistricts = 20;
/// Walks end this far before the street does [m], so that nobody looks out of the town.
constexpr double kOutlook = 25.0;

/// How large the town is, and how often its streets are walked.
struct Plan {
    std::uint32_t blocks = 2, walks = 1;
};

Plan plan_streets(std::uint32_t images) {
    Plan plan;
    const auto way = [](std::uint32_t blocks) {
        const Town town(blocks);
        return (town.street_length() - kOutlook) * town.street_count();
    };
    while (kMaxWalks * way(plan.blocks) < kStep * images) ++plan.blocks;
    plan.walks = static_cast<std::uint32_t>(std::clamp(
        std::floor(kStep * images / way(plan.blocks)), 1.0, static_cast<double>(kMaxWalks)));
    return plan;
}

std::vector<Facade> build_facades(const StreetsOptions& options, const Town& town,
                                  LookAlikeBuilder& builder, Rng& rng) {
    FacadeOptions facade;
    facade.width = Town::kBlock;
    facade.points_per_metre = options.points_per_metre;
    const std::vector<TownSide>& sides = town.sides();
    // The first of a random order are copies, each of one of the others.
    const std::vector<std::size_t> order = random_order(sides.size(), rng.bits());
    const auto copies = std::min<std::size_t>(
        sides.size() - 1, std::llround(options.copied_facades * static_cast<double>(sides.size())));
    std::vector<std::size_t> original(sides.size());
    std::vector<std::size_t> stands(sides.size(), 0);
    for (std::size_t i = 0; i < sides.size(); ++i) {
        original[order[i]] =
            i < copies ? order[copies + rng.below(sides.size() - copies)] : order[i];
        ++stands[original[order[i]]];
    }
    std::vector<SharedDesign> shared(sides.size());
    for (std::size_t i = 0; i < sides.size(); ++i) {
        if (stands[i] < 2) continue;
        shared[i] = share(draw_facade(facade, options.repeated_part, rng), builder);
    }
    std::vector<Facade> facades;
    for (std::size_t i = 0; i < sides.size(); ++i) {
        const bool repeats = stands[original[i]] >= 2;
        const FacadeDesign own =
            draw_facade(facade, repeats ? 1.0 - options.repeated_part : 1.0, rng);
        facades.push_back(build_facade(facade, world_from_facade(sides[i].foot, sides[i].normal),
                                       own, repeats ? &shared[original[i]] : nullptr, builder));
    }
    return facades;
}

/// One walk along a street.
struct Walk {
    TownStreet street;
    std::uint32_t images = 0;
    std::string name;
    bool reverse = false;
    double pan_phase = 0.0;  ///< in periods
};

void add_walk(const Walk& walk, const Town& town, const std::vector<Facade>& facades,
              LookAlikeBuilder& builder, Rng& rng) {
    const Eigen::Vector3d ahead = walk.reverse ? -walk.street.along : walk.street.along;
    const Eigen::Vector3d left = Eigen::Vector3d::UnitZ().cross(ahead);
    const double lateral = rng.uniform(-2.0, 2.0);
    const double length = town.street_length();
    for (std::uint32_t i = 0; i < walk.images; ++i) {
        const double way = (length - kOutlook) * ((i + 0.5) / walk.images);
        const Eigen::Vector3d centre = walk.street.middle + (way - 0.5 * length) * ahead +
                                       lateral * left + Eigen::Vector3d(0, 0, kWalkerHeight) +
                                       0.1 * rng.normal3();
        const double pan =
            kPanRad * std::sin(2.0 * std::numbers::pi * (way / kPanPeriod + walk.pan_phase)) +
            0.02 * rng.normal();
        const double pitch = 0.15 + 0.02 * rng.normal();
        const Eigen::Vector3d look =
            std::cos(pan) * ahead + std::sin(pan) * left + Eigen::Vector3d(0, 0, pitch);
        const ImageId image = builder.add_image(CameraId{0}, look_at(centre, centre + look),
                                                image_name(walk.name, i, walk.images));
        const auto hidden = [&](const Eigen::Vector3d& point) { return town.hides(centre, point); };
        for (const std::size_t side : town.sides_near(centre)) {
            observe_facade(facades[side], image, centre, hidden, builder);
        }
    }
}

}  // namespace

Result<void> validate(const StreetsOptions& options) {
    const auto invalid = [](const char* what) { return Error{ErrorCode::kInvalidArgument, what}; };
    if (options.images < 20 || options.images > 200000) {
        return invalid("streets take 20 to 200000 images");
    }
    if (!(options.points_per_metre > 0.0) || options.points_per_metre > 2000.0) {
        return invalid("points a metre must be above 0 and at most 2000");
    }
    if (!(options.copied_facades >= 0.0) || options.copied_facades > 0.9) {
        return invalid("the part of copied facades must be in 0 ... 0.9");
    }
    if (!(options.repeated_part >= 0.0) || options.repeated_part > 1.0) {
        return invalid("the repeated part must be in 0 ... 1");
    }
    if (!(options.noise_px >= 0.0) || options.noise_px > 10.0) {
        return invalid("noise must be in 0 ... 10 pixels");
    }
    return {};
}

LookAlikeScene make_streets(const StreetsOptions& options, std::uint64_t seed) {
    LookAlikeBuilder builder(seed);
    const Plan plan = plan_streets(options.images);
    const Town town(plan.blocks);
    Rng facade_rng(mix_seed(seed, 36));
    const std::vector<Facade> facades = build_facades(options, town, builder, facade_rng);
    builder.add_camera(make_camera(800, 600, 640.0, FocalSource::kGiven));

    const std::vector<TownStreet> streets = town.streets();
    const std::uint64_t walks = plan.walks * streets.size();
    std::vector<std::uint32_t> images_of_walk;
    for (std::uint64_t w = 0; w < walks; ++w) {
        Rng rng(mix_seed(mix_seed(seed, 37), w));
        Walk walk;
        walk.street = streets[w / plan.walks];
        walk.images = static_cast<std::uint32_t>(options.images * (w + 1) / walks -
                                                 options.images * w / walks);
        // Three digits at least, as many as there are walks.
        walk.name = std::to_string(w + 1);
        walk.name.insert(
            0, std::max<std::size_t>(3, std::to_string(walks).size()) - walk.name.size(), '0');
        walk.name.insert(0, "walk");
        walk.reverse = w % 2 == 1;
        walk.pan_phase = static_cast<double>(w % plan.walks) / plan.walks + 0.1 * rng.uniform();
        add_walk(walk, town, facades, builder, rng);
        images_of_walk.push_back(walk.images);
    }
    LookAlikeScene made = builder.finish(options.noise_px);
    made.order = interleaved_order(images_of_walk, seed);
    made.order_by_district = order_by_stripe(made.scene, made.order,
                                             std::max<std::size_t>(1, options.images / kDistricts));
    return made;
}

}  // namespace psfm::synthetic
