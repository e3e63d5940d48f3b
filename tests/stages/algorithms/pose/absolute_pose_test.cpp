// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/pose/absolute_pose.h"

#include <gtest/gtest.h>

#include "tests/synthetic/rng.h"

namespace psfm {
namespace {

struct Correspondences {
    std::vector<Eigen::Vector2d> pixels;
    std::vector<Eigen::Vector3d> points;
};

const Rigid3 kPose{
    Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d(0.3, 1, -0.2).normalized())),
    {0.2, -0.1, 6.0}};

Camera true_camera() {
    Camera camera = make_camera(1000, 750, 900.0, FocalSource::kGiven);
    camera.params[3] = -0.05;
    return camera;
}

Correspondences make_correspondences(int count, double noise_px, double outliers,
                                     std::uint64_t seed) {
    synthetic::Rng rng(seed);
    Correspondences out;
    while (static_cast<int>(out.points.size()) < count) {
        const Eigen::Vector3d point(rng.uniform(-2, 2), rng.uniform(-2, 2), rng.uniform(-2, 2));
        const auto pixel = project(true_camera(), kPose * point);
        if (!pixel) continue;
        const bool wrong = rng.uniform(0, 1) < outliers;
        out.points.push_back(point);
        out.pixels.emplace_back(
            wrong
                ? Eigen::Vector2d(rng.uniform(0, 1000), rng.uniform(0, 750))
                : Eigen::Vector2d(*pixel + noise_px * Eigen::Vector2d(rng.normal(), rng.normal())));
    }
    return out;
}

TEST(AbsolutePose, SurvivesNoiseAndOutliers) {
    const Correspondences c = make_correspondences(200, 0.5, 0.5, 7);
    const auto pose = estimate_absolute_pose(c.pixels, c.points, true_camera(), false, {}, 1);
    ASSERT_TRUE(pose.ok()) << pose.error().message;
    EXPECT_LT(angle_between(pose->cam_from_world.rotation, kPose.rotation), 0.003);
    EXPECT_LT((pose->cam_from_world.translation - kPose.translation).norm(), 0.02);
    EXPECT_GT(pose->inliers.size(), 90U);
    EXPECT_LT(pose->inliers.size(), 125U);
}

TEST(AbsolutePose, FindsAnUnknownFocalLength) {
    const Correspondences c = make_correspondences(200, 0.3, 0.2, 8);
    Camera guess = make_camera(1000, 750, 1200.0, FocalSource::kUnknown);
    const auto pose = estimate_absolute_pose(c.pixels, c.points, guess, true, {}, 1);
    ASSERT_TRUE(pose.ok()) << pose.error().message;
    EXPECT_NEAR(pose->camera.fx(), 900.0, 25.0);
}

TEST(AbsolutePose, IsTheSameEveryTime) {
    const Correspondences c = make_correspondences(150, 0.5, 0.4, 9);
    const auto first = estimate_absolute_pose(c.pixels, c.points, true_camera(), false, {}, 5);
    const auto second = estimate_absolute_pose(c.pixels, c.points, true_camera(), false, {}, 5);
    ASSERT_TRUE(first.ok() && second.ok());
    EXPECT_EQ(first->cam_from_world.rotation.coeffs(), second->cam_from_world.rotation.coeffs());
    EXPECT_EQ(first->inliers, second->inliers);
}

TEST(AbsolutePose, RefusesTooFewAndRandomPoints) {
    const Correspondences few = make_correspondences(6, 0.0, 0.0, 1);
    const auto too_few =
        estimate_absolute_pose(few.pixels, few.points, true_camera(), false, {}, 1);
    ASSERT_FALSE(too_few.ok());
    EXPECT_EQ(too_few.error().code, ErrorCode::kTooFewMatches);
    const Correspondences random = make_correspondences(100, 0.0, 1.0, 2);
    EXPECT_FALSE(
        estimate_absolute_pose(random.pixels, random.points, true_camera(), false, {}, 1).ok());
}

}  // namespace
}  // namespace psfm
