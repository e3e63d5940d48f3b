// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/merge/geo/gravity.h"

#include <gtest/gtest.h>

#include "tests/stages/merge/located_walk.h"

namespace psfm {
namespace {

using test::held;
using test::kRad;

double off_deg(const Gravity& gravity, const Eigen::Vector3d& truth) {
    return std::acos(std::clamp(gravity.up.dot(truth), -1.0, 1.0)) / kRad;
}

std::vector<OrientedCamera> cameras(std::size_t count, double turn_deg, double pitch_deg,
                                    double roll_deg, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    std::vector<OrientedCamera> result;
    for (std::size_t k = 0; k < count; ++k) {
        result.push_back({held(turn_deg * static_cast<double>(k), pitch_deg + 3.0 * normal(random),
                               roll_deg * normal(random), 1),
                          1});
    }
    return result;
}

TEST(Gravity, EveryOrientationTellsUp) {
    for (const std::uint8_t orientation : std::initializer_list<std::uint8_t>{1, 3, 6, 8}) {
        const Eigen::Quaterniond cam_from_enu = held(30.0, 0.0, 0.0, orientation);
        const Eigen::Vector3d up = cam_from_enu.conjugate() * up_in_camera(orientation);
        EXPECT_NEAR(up.z(), 1.0, 1e-12) << int{orientation};
    }
    // Mirrored ones have the top where their plain neighbours have it.
    EXPECT_EQ(up_in_camera(2), up_in_camera(1));
    EXPECT_EQ(up_in_camera(4), up_in_camera(3));
    EXPECT_EQ(up_in_camera(5), up_in_camera(6));
    EXPECT_EQ(up_in_camera(7), up_in_camera(8));
    EXPECT_EQ(up_in_camera(0), up_in_camera(1));
    EXPECT_EQ(up_in_camera(9), up_in_camera(1));
}

TEST(Gravity, NothingWithoutCameras) {
    EXPECT_FALSE(estimate_gravity({}, {}));
}

TEST(Gravity, ManyHeadingsMakeItSharp) {
    // All look up by 20 degrees, as one does at towers: the horizontal axes alone tell.
    const auto gravity = estimate_gravity(cameras(24, 15.0, 20.0, 2.0, 1), {});
    EXPECT_LT(off_deg(*gravity, Eigen::Vector3d::UnitZ()), 1.5);
    EXPECT_TRUE(gravity->sign_known);
    for (const int axis : {0, 1}) {
        EXPECT_GT(gravity->information(axis, axis), 0.9 / std::pow(1.0 * kRad, 2.0));
    }
    EXPECT_LT(std::abs(gravity->up.dot(gravity->information * gravity->up)), 1e-6);
}

TEST(Gravity, OneHeadingLeavesThePitchOpen) {
    const auto gravity = estimate_gravity(cameras(24, 0.0, 12.0, 2.0, 2), {});
    // North is forward: east is level, and how far north is raised is a habit.
    EXPECT_LT(std::abs(gravity->up.x()), 0.03);
    EXPECT_NEAR(off_deg(*gravity, Eigen::Vector3d::UnitZ()), 12.0, 2.0);
    const Eigen::Vector3d truth = Eigen::Vector3d::UnitZ();
    EXPECT_LT(truth.dot(gravity->information * truth), 1.5);  // within about a standard deviation
}

TEST(Gravity, PortraitAndUpsideDownAgree) {
    test::WalkOptions options;
    options.orientations = {6, 1, 3, 8, 8};
    const test::Walk walk = test::take_walk(test::street(30, 5.0), 0.0, 25.0, options, 3);
    const auto gravity = estimate_gravity(walk.oriented, {});
    const Eigen::Vector3d truth =
        walk.enu_from_component.rotation.conjugate() * Eigen::Vector3d::UnitZ();
    EXPECT_LT(off_deg(*gravity, truth), 1.5);
}

TEST(Gravity, WrongOrientationsAreOutvoted) {
    // A third were taken in portrait by a camera without a sensor for it.
    std::vector<OrientedCamera> all = cameras(30, 37.0, 0.0, 2.0, 4);
    for (std::size_t k = 0; k < all.size(); k += 3)
        all[k].cam_from_frame = held(37.0 * static_cast<double>(k), 0.0, 0.0, 6);
    EXPECT_LT(off_deg(*estimate_gravity(all, {}), Eigen::Vector3d::UnitZ()), 2.0);
}

TEST(Gravity, StraightDownTellsTheAxisOnly) {
    std::vector<OrientedCamera> all;
    for (int k = 0; k < 20; ++k) all.push_back({held(53.0 * k, -90.0, 0.0, 1), 1});
    const auto gravity = estimate_gravity(all, {});
    EXPECT_FALSE(gravity->sign_known);
    EXPECT_LT(std::min(off_deg(*gravity, Eigen::Vector3d::UnitZ()),
                       off_deg(*gravity, -Eigen::Vector3d::UnitZ())),
              1.0);
}

}  // namespace
}  // namespace psfm
