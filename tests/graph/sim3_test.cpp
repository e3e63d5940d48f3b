// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "graph/sim3.h"

#include <gtest/gtest.h>

#include <numbers>

#include "graph/camera.h"
#include "tests/synthetic/rng.h"
#include "tests/synthetic/scene.h"

namespace psfm {
namespace {

using synthetic::random_gauge;
using synthetic::Rng;

TEST(Sim3, DefaultIsIdentity) {
    const Eigen::Vector3d x(1, 2, 3);
    EXPECT_EQ(Sim3{} * x, x);
}

TEST(Sim3, MovesAPointByHand) {
    Sim3 motion;
    motion.scale = 2.0;
    motion.rotation = Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitZ());
    motion.translation = {10, 20, 30};
    EXPECT_TRUE((motion * Eigen::Vector3d(1, 0, 0)).isApprox(Eigen::Vector3d(10, 22, 30), 1e-12));
}

TEST(Sim3, ChainsCancel) {
    Rng rng(1);
    for (std::uint64_t trial = 0; trial < 1000; ++trial) {
        const Sim3 b_from_a = random_gauge(3 * trial);
        const Sim3 c_from_b = random_gauge(3 * trial + 1);
        const Sim3 d_from_c = random_gauge(3 * trial + 2);
        const Eigen::Vector3d x = 5.0 * rng.normal3();
        EXPECT_LT(((c_from_b * b_from_a) * x - c_from_b * (b_from_a * x)).norm(), 1e-10);
        const Sim3 left = (d_from_c * c_from_b) * b_from_a;
        const Sim3 right = d_from_c * (c_from_b * b_from_a);
        EXPECT_NEAR(left.scale / right.scale, 1.0, 1e-14);
        EXPECT_LT(angle_between(left.rotation, right.rotation), 1e-13);
        EXPECT_LT((left.translation - right.translation).norm(), 1e-9);
    }
}

TEST(Sim3, InverseUndoes) {
    Rng rng(2);
    for (std::uint64_t trial = 0; trial < 1000; ++trial) {
        const Sim3 b_from_a = random_gauge(trial);
        const Eigen::Vector3d x = 5.0 * rng.normal3();
        EXPECT_LT((inverse(b_from_a) * (b_from_a * x) - x).norm(), 1e-11);
        EXPECT_LT((b_from_a * (inverse(b_from_a) * x) - x).norm(), 1e-11);
    }
}

TEST(TransformPose, MovesTheCentreWithItsWorld) {
    Rng rng(3);
    for (std::uint64_t trial = 0; trial < 1000; ++trial) {
        const Rigid3 cam_from_source{rng.rotation(), 5.0 * rng.normal3()};
        const Sim3 target_from_source = random_gauge(trial);
        const Rigid3 cam_from_target = transform_pose(cam_from_source, target_from_source);
        const Eigen::Vector3d expected =
            target_from_source * cam_from_source.target_origin_in_source();
        EXPECT_LT((cam_from_target.target_origin_in_source() - expected).norm(), 1e-11);
        EXPECT_NEAR(cam_from_target.rotation.norm(), 1.0, 1e-14);
    }
}

TEST(TransformPose, KeepsProjectionsAndScalesDepths) {
    const Camera camera = make_camera(1000, 750, 900.0, FocalSource::kGiven);
    Rng rng(4);
    for (std::uint64_t trial = 0; trial < 1000; ++trial) {
        const Rigid3 cam_from_source{rng.rotation(), 5.0 * rng.normal3()};
        const Sim3 target_from_source = random_gauge(trial);
        const Rigid3 cam_from_target = transform_pose(cam_from_source, target_from_source);
        const Eigen::Vector3d in_cam(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(2, 20));
        const Eigen::Vector3d point = inverse(cam_from_source) * in_cam;
        const Eigen::Vector3d moved = cam_from_target * (target_from_source * point);
        EXPECT_NEAR(moved.z() / in_cam.z(), target_from_source.scale, 1e-9);
        EXPECT_LT((*project(camera, moved) - *project(camera, in_cam)).norm(), 1e-8);
    }
}

TEST(TransformPose, ComposesAndIsUndone) {
    Rng rng(5);
    for (std::uint64_t trial = 0; trial < 1000; ++trial) {
        const Rigid3 cam_from_a{rng.rotation(), 5.0 * rng.normal3()};
        const Sim3 b_from_a = random_gauge(2 * trial);
        const Sim3 c_from_b = random_gauge(2 * trial + 1);
        const Rigid3 in_steps = transform_pose(transform_pose(cam_from_a, b_from_a), c_from_b);
        const Rigid3 at_once = transform_pose(cam_from_a, c_from_b * b_from_a);
        EXPECT_LT(angle_between(in_steps.rotation, at_once.rotation), 1e-13);
        EXPECT_LT((in_steps.translation - at_once.translation).norm(), 1e-9);
        const Rigid3 back = transform_pose(transform_pose(cam_from_a, b_from_a), inverse(b_from_a));
        EXPECT_LT((back.translation - cam_from_a.translation).norm(), 1e-10);
    }
}

}  // namespace
}  // namespace psfm
