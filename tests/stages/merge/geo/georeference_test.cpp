// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/merge/geo/georeference.h"

#include <gtest/gtest.h>

#include "tests/stages/merge/located_walk.h"

namespace psfm {
namespace {

using test::take_walk;
using test::Walk;
using test::WalkOptions;

Result<Georeference> with_gravity(const Walk& walk) {
    return estimate_georeference(walk.cameras, estimate_gravity(walk.oriented, {}), std::nullopt,
                                 {});
}

Result<Georeference> without_gravity(const Walk& walk) {
    return estimate_georeference(walk.cameras, std::nullopt, std::nullopt, {});
}

TEST(Georeference, ExactPositionsGiveTheTruth) {
    WalkOptions exact;
    exact.horizontal_noise = exact.vertical_noise = 0.0;
    exact.roll_noise_deg = exact.pitch_noise_deg = 0.0;
    for (const auto& places : {test::street(12, 8.0), test::around(12, 40.0)}) {
        const Walk walk = take_walk(places, 0.0, 40.0, exact, 1);
        const auto found = with_gravity(walk);
        ASSERT_TRUE(found.ok()) << found.error().message;
        EXPECT_LT(walk.largest_error(found->enu_from_component), 1e-3);
        EXPECT_LT(walk.turned_deg(found->enu_from_component), 1e-2);
        EXPECT_TRUE(found->with_gravity);
        EXPECT_EQ(found->agreement.inliers, 12U);
        EXPECT_LT(found->agreement.max_m, 1e-3);
    }
}

TEST(Georeference, AStreetStandsUprightThroughGravity) {
    for (const std::uint64_t seed : {1, 2, 3, 4, 5}) {
        WalkOptions options;
        options.orientations = {1, 6, 8, 3};
        const Walk walk = take_walk(test::street(30, 8.0), 37.0, 30.0, options, seed);
        const auto found = with_gravity(walk);
        ASSERT_TRUE(found.ok()) << found.error().message;
        EXPECT_LT(walk.turned_deg(found->enu_from_component), 3.0) << seed;
        EXPECT_NEAR(found->enu_from_component.scale / walk.enu_from_component.scale, 1.0, 0.06);
        EXPECT_LT(walk.largest_error(found->enu_from_component), 11.0) << seed;
        // Without gravity nothing tells the turn about the street.
        const auto open = without_gravity(walk);
        ASSERT_FALSE(open.ok()) << seed;
        EXPECT_EQ(open.error().code, ErrorCode::kDegenerate);
    }
}

TEST(Georeference, PositionsInAPlaneNeedNoGravity) {
    for (const std::uint64_t seed : {1, 2, 3}) {
        const Walk walk = take_walk(test::around(40, 120.0), 0.0, 9.0, {}, seed);
        const auto found = without_gravity(walk);
        ASSERT_TRUE(found.ok()) << found.error().message;
        EXPECT_FALSE(found->with_gravity);
        EXPECT_LT(walk.turned_deg(found->enu_from_component), 5.0) << seed;
    }
}

TEST(Georeference, GravityThatPositionsContradictIsLeftOut) {
    // Everything was photographed with the camera lying on its side, and no sensor for it.
    WalkOptions options;
    options.horizontal_noise = 2.0;
    options.vertical_noise = 4.0;
    options.orientations = {6};
    Walk walk = take_walk(test::around(40, 120.0), 0.0, 0.0, options, 7);
    for (OrientedCamera& camera : walk.oriented) camera.orientation = 1;
    const auto found = with_gravity(walk);
    ASSERT_TRUE(found.ok()) << found.error().message;
    EXPECT_FALSE(found->with_gravity);
    EXPECT_LT(walk.turned_deg(found->enu_from_component), 3.0);
}

TEST(Georeference, AerialPhotographsAreNotUpsideDown) {
    WalkOptions options;
    Walk walk = take_walk(test::around(40, 80.0), 0.0, 0.0, options, 8);
    for (std::size_t k = 0; k < walk.oriented.size(); ++k) {
        walk.oriented[k].cam_from_frame = test::held(53.0 * static_cast<double>(k), -90.0, 0.0, 1) *
                                          walk.enu_from_component.rotation;
    }
    const auto found = with_gravity(walk);
    ASSERT_TRUE(found.ok()) << found.error().message;
    EXPECT_LT(walk.turned_deg(found->enu_from_component), 5.0);
}

TEST(Georeference, AThirdOfThePositionsMayBeWrong) {
    for (const std::uint64_t seed : {1, 2, 3, 4}) {
        WalkOptions options;
        options.outliers = 0.35;
        const Walk walk = take_walk(test::street(40, 8.0), 37.0, 30.0, options, seed);
        const auto found = with_gravity(walk);
        ASSERT_TRUE(found.ok()) << found.error().message;
        EXPECT_LT(walk.turned_deg(found->enu_from_component), 4.0) << seed;
        EXPECT_LT(walk.largest_error(found->enu_from_component), 16.0) << seed;
        EXPECT_LT(found->agreement.inliers, 36U);
    }
}

TEST(Georeference, MostOfThemMayNot) {
    WalkOptions options;
    options.outliers = 0.8;
    const auto found = with_gravity(take_walk(test::street(40, 8.0), 37.0, 30.0, options, 5));
    ASSERT_FALSE(found.ok());
    EXPECT_NE(found.error().message.find("agree"), std::string::npos) << found.error().message;
}

TEST(Georeference, AltitudesMayBeMissing) {
    WalkOptions options;
    options.altitudes = false;
    const Walk walk = take_walk(test::street(30, 8.0), 37.0, 30.0, options, 6);
    const auto found = with_gravity(walk);
    ASSERT_TRUE(found.ok()) << found.error().message;
    EXPECT_LT(walk.turned_deg(found->enu_from_component), 3.0);
    double mean_height = 0.0;
    for (const LocatedCamera& camera : walk.cameras)
        mean_height += (found->enu_from_component * camera.centre).z() / 30.0;
    EXPECT_NEAR(mean_height, 0.0, 1e-3);  // the datum's
}

TEST(Georeference, TooFewOrTooCloseIsTooLittle) {
    EXPECT_FALSE(with_gravity(take_walk(test::street(2, 100.0), 0.0, 40.0, {}, 1)).ok());
    EXPECT_TRUE(with_gravity(take_walk(test::street(3, 50.0), 0.0, 40.0, {}, 1)).ok());
    for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6, 7, 8}) {
        // Around a statue: the positions' spread is their error.
        const auto found = with_gravity(take_walk(test::around(200, 2.0), 0.0, 3.0, {}, seed));
        EXPECT_FALSE(found.ok()) << seed;
        // Five photographs within 12 m.
        EXPECT_FALSE(with_gravity(take_walk(test::street(5, 3.0), 0.0, 40.0, {}, seed)).ok());
    }
}

TEST(Georeference, OnePositionMoreMovesItByItsShare) {
    const Walk walk = take_walk(test::street(60, 5.0), 37.0, 30.0, {}, 9);
    const auto gravity = estimate_gravity(walk.oriented, {});
    std::optional<Sim3> before;
    for (std::size_t count = 20; count <= walk.cameras.size(); ++count) {
        const auto found =
            estimate_georeference(std::span(walk.cameras).first(count), gravity, before, {});
        ASSERT_TRUE(found.ok());
        for (std::size_t k = 0; before && k + 1 < count; ++k) {
            const Eigen::Vector3d& centre = walk.cameras[k].centre;
            // Least squares of a line: the share of a point at its end is 4 / n of its residual.
            EXPECT_LT((found->enu_from_component * centre - *before * centre).norm(),
                      4.0 / static_cast<double>(count) * 25.0)
                << count;
        }
        before = found->enu_from_component;
    }
}

}  // namespace
}  // namespace psfm
