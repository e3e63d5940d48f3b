// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/localisation/pose_covariance.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/synthetic/rng.h"

namespace psfm {
namespace {

const Camera kCamera = make_camera(1000, 800, 900.0, FocalSource::kExif);
const Rigid3 kPose{Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY())),
                   {0.2, -0.1, 6.0}};

struct Seen {
    std::vector<Eigen::Vector2d> pixels;
    std::vector<Eigen::Vector3d> points;
};

Seen see(std::size_t count, double noise, std::uint64_t seed) {
    synthetic::Rng rng(seed);
    Seen seen;
    while (seen.points.size() < count) {
        const Eigen::Vector3d point = rng.normal3();
        const auto pixel = project(kCamera, kPose * point);
        if (!pixel) continue;
        seen.points.push_back(point);
        seen.pixels.push_back(*pixel + noise * Eigen::Vector2d(rng.normal(), rng.normal()));
    }
    return seen;
}

// The centre's spread along its axes follows from noise, distance and focal length: sideways about
// distance / focal x noise / sqrt(N), and more where a turn can make up for it.
TEST(PoseCovariance, IsOfTheSizeOfTheErrorsThatNoiseMakes) {
    const auto some =
        pose_covariance(see(400, 0.5, 1).pixels, see(400, 0.5, 1).points, kCamera, kPose);
    ASSERT_TRUE(some);
    const Seen more = see(1600, 0.5, 2);
    const auto four_times = pose_covariance(more.pixels, more.points, kCamera, kPose);
    ASSERT_TRUE(four_times);
    EXPECT_TRUE(some->isApprox(some->transpose(), 1e-9));
    for (int axis = 0; axis < 6; ++axis) {
        const double ratio = (*some)(axis, axis) / (*four_times)(axis, axis);
        EXPECT_GT(ratio, 2.5) << axis;
        EXPECT_LT(ratio, 6.0) << axis;
    }
    const double sideways = std::sqrt((*some)(3, 3));
    EXPECT_GT(sideways, 0.5 * 6.0 / 900.0 * 0.5 / std::sqrt(400.0));
    EXPECT_LT(sideways, 50.0 * 6.0 / 900.0 * 0.5 / std::sqrt(400.0));
    const Seen noisier = see(400, 5.0, 1);
    const auto worse = pose_covariance(noisier.pixels, noisier.points, kCamera, kPose);
    ASSERT_TRUE(worse);
    EXPECT_NEAR((*worse)(4, 4) / (*some)(4, 4), 100.0, 1.0);
}

TEST(PoseCovariance, OfTooLittleIsNone) {
    const Seen three = see(3, 0.5, 1);
    EXPECT_FALSE(pose_covariance(three.pixels, three.points, kCamera, kPose));
    EXPECT_FALSE(pose_covariance({}, {}, kCamera, kPose));
    // Points behind the camera say nothing.
    Seen behind = see(10, 0.5, 1);
    for (Eigen::Vector3d& point : behind.points) point = inverse(kPose) * Eigen::Vector3d(0, 0, -2);
    EXPECT_FALSE(pose_covariance(behind.pixels, behind.points, kCamera, kPose));
}

}  // namespace
}  // namespace psfm
