// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/verification/find_still.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <iterator>

#include "stages/algorithms/two_view/invert_two_view_geometry.h"
#include "stages/verification/verify_pair.h"
#include "tests/stages/verification/two_views.h"

namespace psfm {
namespace {

using test::keypoint_at;
using test::make_two_views;
using test::TwoViewOptions;
using test::TwoViews;

constexpr std::uint64_t kSeed = 7;

/// Where on a photograph of 1500 x 1000 something is shown.
struct Area {
    double left, top, width, height;
};
constexpr Area kLogo{1150, 800, 300, 150};
constexpr Area kEverywhere{0, 0, 1500, 1000};

Eigen::Vector2d place_in(const Area& area, synthetic::Rng& rng) {
    const double x = area.left + area.width * rng.uniform();
    return {x, area.top + area.height * rng.uniform()};
}

/// Adds matches that stand still, but for noise. @return the first of them
std::uint32_t add_still(TwoViews& views, const Area& area, int count, std::uint64_t seed) {
    synthetic::Rng rng(seed);
    const auto first = static_cast<std::uint32_t>(views.keypoints1.size());
    for (int i = 0; i < count; ++i) {
        const Eigen::Vector2d place = place_in(area, rng);
        const auto noise = [&] { return Eigen::Vector2d(0.2 * rng.normal(), 0.2 * rng.normal()); };
        const auto index = static_cast<std::uint32_t>(views.keypoints1.size());
        views.keypoints1.push_back(keypoint_at(place + noise()));
        views.keypoints2.push_back(keypoint_at(place + noise()));
        views.matches.push_back({index, index});
        views.is_true.push_back(false);
    }
    return first;
}

/// Features that match nothing.
void add_features(TwoViews& views, int count, std::uint64_t seed) {
    synthetic::Rng rng(seed);
    for (int i = 0; i < count; ++i) {
        views.keypoints1.push_back(keypoint_at(place_in(kEverywhere, rng)));
        views.keypoints2.push_back(keypoint_at(place_in(kEverywhere, rng)));
    }
}

std::size_t count_from(const std::vector<FeatureMatch>& matches, std::uint32_t first) {
    return static_cast<std::size_t>(
        std::ranges::count_if(matches, [&](const FeatureMatch& m) { return m.first >= first; }));
}

TwoViews no_views() {
    TwoViewOptions options;
    options.matches = 0;
    return make_two_views(options, 1);
}

TEST(FindStill, OrdinaryPairsHaveNone) {
    for (const std::uint64_t scene : {1U, 2U, 3U})
        EXPECT_TRUE(find_still(make_two_views({}, scene).matched(), {}).empty());
}

TEST(FindStill, IsWhatLiesAtOnePlaceInBoth) {
    TwoViews views = make_two_views({}, 4);
    const std::uint32_t first = add_still(views, kLogo, 60, 5);
    const auto still = find_still(views.matched(), {});
    EXPECT_GE(count_from(still, first), 59U);
    EXPECT_EQ(still.size(), count_from(still, first));
    EXPECT_TRUE(std::ranges::is_sorted(still));
}

TEST(FindStill, AWatermarkIsWhereTheCornerIs) {
    // Landscape and portrait: it stands as far from the right lower corner in both.
    TwoViews views = no_views();
    add_still(views, kLogo, 60, 5);
    views.camera2 = make_camera(1000, 1500, 1400, FocalSource::kGiven);
    for (Keypoint& keypoint : views.keypoints2) {
        keypoint.x -= 500.F;
        keypoint.y += 500.F;
    }
    EXPECT_GE(find_still(views.matched(), {}).size(), 59U);
    const auto geometry = verify_pair(views.matched(), {}, kSeed);
    ASSERT_TRUE(geometry.ok());
    EXPECT_TRUE(is_still_only(*geometry));
    for (Keypoint& keypoint : views.keypoints2) keypoint.x += 20.F;
    EXPECT_TRUE(find_still(views.matched(), {}).empty());
}

TEST(FindStill, ScaleAndOrientationAreThoseOfOneThing) {
    TwoViews views = no_views();
    add_still(views, kLogo, 60, 5);
    for (std::size_t i = 0; i < 30; ++i) views.keypoints2[i].scale *= 1.5F;
    for (std::size_t i = 30; i < 50; ++i) views.keypoints2[i].angle += 0.5F;
    for (std::size_t i = 50; i < 60; ++i) views.keypoints2[i].angle += 6.28F;
    EXPECT_GE(find_still(views.matched(), {}).size(), 9U);
    EXPECT_LE(find_still(views.matched(), {}).size(), 10U);
}

TEST(StillCoverage, TellsAPlaceFromEverywhere) {
    TwoViews logo = no_views();
    add_still(logo, kLogo, 100, 5);
    add_features(logo, 2000, 6);
    EXPECT_LT(still_coverage(logo.matched(), find_still(logo.matched(), {}), {}), 0.25);
    TwoViews tripod = no_views();
    add_still(tripod, kEverywhere, 300, 5);
    add_features(tripod, 2000, 6);
    EXPECT_GT(still_coverage(tripod.matched(), find_still(tripod.matched(), {}), {}), 0.9);
    EXPECT_EQ(still_coverage(no_views().matched(), {}, {}), 0.0);
}

TEST(VerifyPairStill, TheSceneIsWhatMovesHoweverMuchDoesNot) {
    for (const FocalSource source : {FocalSource::kGiven, FocalSource::kUnknown}) {
        for (const int still_matches : {20, 100, 1000}) {
            TwoViewOptions options;
            options.matches = 150;
            options.camera1.focal_source = options.camera2.focal_source = source;
            TwoViews views = make_two_views(options, 11);
            const std::uint32_t first = add_still(views, kLogo, still_matches, 12);
            add_features(views, 2000, 13);
            const auto geometry = verify_pair(views.matched(), {}, kSeed);
            ASSERT_TRUE(geometry.ok()) << geometry.error().message;
            EXPECT_NE(geometry->kind, TwoViewKind::kPureRotation);
            EXPECT_GE(geometry->inliers.size(), 95U);
            EXPECT_LE(count_from(geometry->inliers, first), 1U);
            EXPECT_GE(100 * geometry->still.size(), 95 * static_cast<std::size_t>(still_matches));
            if (source != FocalSource::kGiven) continue;
            EXPECT_LT(test::rotation_error_deg(geometry->cam2_from_cam1, views.cam2_from_cam1),
                      0.4);
        }
    }
}

TEST(VerifyPairStill, TwoScenesWithOneLogoAreNoPair) {
    TwoViews views = no_views();
    add_still(views, kLogo, 120, 21);
    add_features(views, 2000, 22);
    const auto geometry = verify_pair(views.matched(), {}, kSeed);
    ASSERT_TRUE(geometry.ok());
    EXPECT_TRUE(is_still_only(*geometry));
    EXPECT_GE(geometry->still.size(), 118U);
    EXPECT_EQ(geometry->cam2_from_cam1.translation.norm(), 0.0);
}

TEST(VerifyPairStill, ACameraThatStoodStillIsARotationByNothing) {
    TwoViews views = no_views();
    add_still(views, kEverywhere, 400, 31);
    add_features(views, 1500, 32);
    const auto geometry = verify_pair(views.matched(), {}, kSeed);
    ASSERT_TRUE(geometry.ok()) << geometry.error().message;
    EXPECT_EQ(geometry->kind, TwoViewKind::kPureRotation);
    EXPECT_GE(geometry->inliers.size(), 395U);
    EXPECT_LT(test::degrees(
                  angle_between(geometry->cam2_from_cam1.rotation, Eigen::Quaterniond::Identity())),
              0.01);
}

TEST(VerifyPairStill, SomebodyWhoWalksBeforeATripodIsNoScene) {
    TwoViewOptions options;
    options.matches = 60;
    options.wrong = 1.0;
    TwoViews views = make_two_views(options, 41);
    add_still(views, kEverywhere, 400, 42);
    add_features(views, 1500, 43);
    const auto geometry = verify_pair(views.matched(), {}, kSeed);
    ASSERT_TRUE(geometry.ok()) << geometry.error().message;
    EXPECT_EQ(geometry->kind, TwoViewKind::kPureRotation);
}

TEST(VerifyPairStill, FarViewsStayInTheScene) {
    // The camera moves to the side and does not turn: what is far stands still, what is near moves.
    synthetic::Rng rng(51);
    TwoViews views = no_views();
    const Eigen::Vector3d baseline(-0.5, 0.0, 0.02);
    for (int i = 0; i < 120; ++i) {
        const Eigen::Vector2d place = place_in({0, 400, 1500, 600}, rng);
        const double depth = rng.uniform(4, 12);
        const Eigen::Vector3d point =
            depth * normalized_from_pixel(views.camera1, place).homogeneous();
        const auto moved = project(views.camera2, point + baseline);
        ASSERT_TRUE(moved);
        const auto index = static_cast<std::uint32_t>(views.keypoints1.size());
        views.keypoints1.push_back(keypoint_at(place));
        views.keypoints2.push_back(keypoint_at(*moved));
        views.matches.push_back({index, index});
        views.is_true.push_back(true);
    }
    const std::uint32_t first = add_still(views, {0, 0, 1500, 400}, 300, 52);
    add_features(views, 1000, 53);
    const auto geometry = verify_pair(views.matched(), {}, kSeed);
    ASSERT_TRUE(geometry.ok()) << geometry.error().message;
    EXPECT_EQ(geometry->kind, TwoViewKind::kEssential);
    EXPECT_GE(count_from(geometry->inliers, first), 280U);
    EXPECT_GE(geometry->inliers.size(), 400U);
    EXPECT_GE(geometry->still.size(), 290U);
    EXPECT_LT(test::direction_error_deg(geometry->cam2_from_cam1,
                                        {Eigen::Quaterniond::Identity(), baseline}),
              1.0);
}

TEST(VerifyPairStill, ExchangedWithTheImages) {
    TwoViews views = make_two_views({}, 61);
    add_still(views, kLogo, 60, 62);
    const auto geometry = verify_pair(views.matched(), {}, kSeed);
    ASSERT_TRUE(geometry.ok());
    ASSERT_FALSE(geometry->still.empty());
    const TwoViewGeometry back = invert(invert(*geometry));
    EXPECT_EQ(back.still, geometry->still);
    EXPECT_TRUE(std::ranges::is_sorted(invert(*geometry).still));
}

TEST(VerifyPairStill, CanBeTurnedOff) {
    TwoViews views = no_views();
    add_still(views, kLogo, 120, 21);
    VerifyOptions options;
    options.still.min_matches = 0;
    const auto geometry = verify_pair(views.matched(), options, kSeed);
    ASSERT_TRUE(geometry.ok());
    EXPECT_TRUE(geometry->still.empty());
    EXPECT_FALSE(geometry->inliers.empty());
}

}  // namespace
}  // namespace psfm
