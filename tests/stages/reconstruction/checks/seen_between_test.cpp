// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/checks/seen_between.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "stages/reconstruction/checks/companions.h"
#include "tests/stages/reconstruction/two_streets.h"

namespace psfm {
namespace {

using synthetic::SyntheticScene;

constexpr std::uint32_t kImages = 40;

Reconstruction model_of(const SyntheticScene& scene) {
    return synthetic::true_reconstruction(scene, synthetic::random_gauge(3));
}

/// Steps of half a metre, 6 m before the wall.
SyntheticScene dense_walk(std::uint32_t images) {
    synthetic::SceneOptions options = synthetic::line_along_wall(images);
    options.cameras.radius = 0.25 * images;
    return synthetic::make_scene(options, 1);
}

struct Sum {
    double expected = 0.0;
    double shared = 0.0;
    double part() const { return shared / expected; }
};

template <typename Counts>
Sum sum_of(const std::vector<SeenBetween>& pairs, const Counts& counts) {
    Sum sum;
    for (const SeenBetween& pair : pairs) {
        if (!counts(pair)) continue;
        sum.expected += pair.expected;
        sum.shared += pair.shared;
    }
    return sum;
}

bool all(const SeenBetween&) {
    return true;
}
bool of_two_streets(const SeenBetween& pair) {
    return (pair.second - pair.first) % 2 == 1;
}

/// Every third observation of a model gets lost, as in photographs.
Reconstruction with_gaps(Reconstruction model) {
    std::vector<ScenePoint> points = model.points.to_vector();
    std::uint32_t count = 0;
    for (ScenePoint& point : points)
        std::erase_if(point.track, [&](const Observation&) { return ++count % 3 == 0; });
    std::erase_if(points, [](const ScenePoint& point) { return point.track.size() < 2; });
    model.points = std::move(points);
    return model;
}

TEST(SeenBetween, ARightModelSharesNearlyAll) {
    for (const SyntheticScene& scene :
         {dense_walk(kImages), synthetic::make_scene(synthetic::ring_in_room(kImages), 1)}) {
        const auto pairs = find_seen_between(with_gaps(model_of(scene)), {});
        const Sum sum = sum_of(pairs, all);
        EXPECT_GT(sum.expected, 500.0);
        EXPECT_GT(sum.part(), 0.9);
        EXPECT_TRUE(std::ranges::is_sorted(
            pairs, {}, [](const SeenBetween& pair) { return std::pair(pair.first, pair.second); }));
    }
}

TEST(SeenBetween, WithoutCompanionsWhatGetsLostIsMissed) {
    const Reconstruction model = with_gaps(model_of(dense_walk(kImages)));
    BetweenOptions alone;
    alone.companions = 0;
    EXPECT_NEAR(sum_of(find_seen_between(model, alone), all).part(), 2.0 / 3.0, 0.1);
}

TEST(SeenBetween, TwoStreetsInOneShareWhatIsAlike) {
    const auto pairs = find_seen_between(with_gaps(model_of(two_streets(kImages, 0.4, 2))), {});
    const Sum across = sum_of(pairs, of_two_streets);
    EXPECT_GT(across.expected, 1000.0);
    EXPECT_LT(across.part(), 0.7);
    EXPECT_GT(sum_of(pairs, [](const SeenBetween& pair) { return !of_two_streets(pair); }).part(),
              0.95);
}

TEST(SeenBetween, AFewPointsSayTheSame) {
    const Reconstruction model = with_gaps(model_of(two_streets(kImages, 0.4, 2)));
    const Sum of_all = sum_of(find_seen_between(model, {}), of_two_streets);
    const Sum of_few = sum_of(find_seen_between(model, {}, 20), of_two_streets);
    EXPECT_NEAR(of_few.part(), of_all.part(), 0.05);
    EXPECT_NEAR(of_few.expected, of_all.expected, 0.2 * of_all.expected) << "each counts for more";
}

TEST(SeenBetween, WhoStandsBesideAllWhoSeeAPointNeedNotSeeIt) {
    // The last image of a walk sees nothing of its own; all others stand on one side of it.
    const SyntheticScene scene = dense_walk(24);
    Reconstruction model = synthetic::true_reconstruction(scene);
    const Eigen::Vector3d first = model.images.front().cam_from_cluster.target_origin_in_source();
    const auto last = std::ranges::max_element(model.images, {}, [&](const RegisteredImage& image) {
        return (image.cam_from_cluster.target_origin_in_source() - first).norm();
    });
    std::vector<ScenePoint> points = model.points.to_vector();
    for (ScenePoint& point : points)
        std::erase_if(point.track, [&](const Observation& o) { return o.image == last->image; });
    std::erase_if(points, [](const ScenePoint& point) { return point.track.size() < 2; });
    model.points = std::move(points);
    const auto own = static_cast<std::uint32_t>(last - model.images.begin());
    const auto pairs = find_seen_between(model, {});
    ASSERT_GT(sum_of(pairs, all).expected, 100.0);
    EXPECT_TRUE(std::ranges::none_of(
        pairs, [&](const SeenBetween& pair) { return pair.first == own || pair.second == own; }));
}

/// What two of three observations of an image show is not found in it.
Reconstruction with_losses_of(ImageId image, Reconstruction model) {
    std::vector<ScenePoint> points = model.points.to_vector();
    std::uint32_t count = 0;
    for (ScenePoint& point : points) {
        std::erase_if(point.track, [&](const Observation& observation) {
            return observation.image == image && ++count % 3 != 0;
        });
    }
    std::erase_if(points, [](const ScenePoint& point) { return point.track.size() < 2; });
    model.points = std::move(points);
    return model;
}

TEST(SeenBetween, WhatAZoomedImageShowsLargerThanAllOthersNeedNotBeFoundInIt) {
    constexpr std::uint32_t kOwn = kImages / 2;
    constexpr double kZoom = 2.0;
    const Reconstruction whole = synthetic::true_reconstruction(dense_walk(kImages));
    Reconstruction model = with_losses_of(whole.images[kOwn].image, whole);
    BetweenOptions alone;
    alone.companions = 0;
    const auto of_own = [](const SeenBetween& pair) {
        return pair.first == kOwn || pair.second == kOwn;
    };
    const Sum as_others = sum_of(find_seen_between(model, alone), of_own);
    ASSERT_GT(as_others.expected, 500.0);
    EXPECT_LT(as_others.part(), 0.8);

    constexpr CameraId kZoomed{1000};
    Camera zoomed = model.cameras.at(model.images[kOwn].camera);
    zoomed.params[0] *= kZoom;
    model.cameras.emplace(kZoomed, zoomed);
    model.images[kOwn].camera = kZoomed;
    const Sum larger = sum_of(find_seen_between(model, alone), of_own);
    ASSERT_GT(larger.expected, 100.0) << "of others, who have to see what it sees";
    EXPECT_GT(larger.part(), 0.95);
}

TEST(SeenBetween, AnEmptyModelExpectsNothing) {
    EXPECT_TRUE(find_seen_between({}, {}).empty());
}

TEST(SeenBetween, OptionsAreChecked) {
    BetweenOptions options;
    EXPECT_TRUE(validate(options).ok());
    options.grid = 0;
    EXPECT_FALSE(validate(options).ok());
    options = {};
    options.min_asked = 0;
    EXPECT_FALSE(validate(options).ok());
    options = {};
    options.max_spread_deg = options.min_spread_deg;
    EXPECT_FALSE(validate(options).ok());
}

TEST(Companions, AreThoseWithMostInCommon) {
    const Reconstruction model = synthetic::true_reconstruction(dense_walk(kImages));
    const auto companions = companions_of(model, 4);
    ASSERT_EQ(companions.size(), kImages);
    for (std::uint32_t i = 0; i < kImages; ++i) {
        ASSERT_EQ(companions[i].size(), 4U);
        const Eigen::Vector3d own = model.images[i].cam_from_cluster.target_origin_in_source();
        for (const std::uint32_t other : companions[i]) {
            EXPECT_NE(other, i);
            const Eigen::Vector3d theirs =
                model.images[other].cam_from_cluster.target_origin_in_source();
            EXPECT_LT((own - theirs).norm(), 5.0) << "of a walk of 20 m";
        }
    }
    EXPECT_TRUE(companions_of({}, 4).empty());
}

}  // namespace
}  // namespace psfm
