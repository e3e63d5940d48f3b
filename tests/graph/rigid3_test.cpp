// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "graph/rigid3.h"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/synthetic/rng.h"

namespace psfm {
namespace {

using synthetic::Rng;

Rigid3 random_motion(Rng& rng) {
    Rigid3 motion;
    motion.rotation = rng.rotation();
    motion.translation = 10.0 * rng.normal3();
    return motion;
}

TEST(Rigid3, DefaultIsIdentity) {
    const Eigen::Vector3d x(1, 2, 3);
    EXPECT_EQ(Rigid3{} * x, x);
}

TEST(Rigid3, MovesAPointByHand) {
    // A quarter turn about z takes x to y.
    Rigid3 motion;
    motion.rotation = Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitZ());
    motion.translation = {10, 20, 30};
    EXPECT_TRUE((motion * Eigen::Vector3d(1, 0, 0)).isApprox(Eigen::Vector3d(10, 21, 30), 1e-12));
    EXPECT_TRUE(motion.target_origin_in_source().isApprox(Eigen::Vector3d(-20, 10, -30), 1e-12));
}

TEST(Rigid3, ChainsCancel) {
    Rng rng(1);
    for (int trial = 0; trial < 1000; ++trial) {
        const Rigid3 b_from_a = random_motion(rng);
        const Rigid3 c_from_b = random_motion(rng);
        const Rigid3 c_from_a = c_from_b * b_from_a;
        const Eigen::Vector3d x = 5.0 * rng.normal3();
        EXPECT_LT((c_from_a * x - c_from_b * (b_from_a * x)).norm(), 1e-11);
    }
}

TEST(Rigid3, IsAssociative) {
    Rng rng(2);
    for (int trial = 0; trial < 1000; ++trial) {
        const Rigid3 a = random_motion(rng);
        const Rigid3 b = random_motion(rng);
        const Rigid3 c = random_motion(rng);
        const Rigid3 left = (a * b) * c;
        const Rigid3 right = a * (b * c);
        EXPECT_LT(angle_between(left.rotation, right.rotation), 1e-13);
        EXPECT_LT((left.translation - right.translation).norm(), 1e-11);
    }
}

TEST(Rigid3, InverseUndoes) {
    Rng rng(3);
    for (int trial = 0; trial < 1000; ++trial) {
        const Rigid3 motion = random_motion(rng);
        const Eigen::Vector3d x = 5.0 * rng.normal3();
        EXPECT_LT((inverse(motion) * (motion * x) - x).norm(), 1e-11);
        const Rigid3 nothing = motion * inverse(motion);
        EXPECT_LT(rotation_angle(nothing.rotation), 1e-13);
        EXPECT_LT(nothing.translation.norm(), 1e-11);
    }
}

TEST(Rigid3, OriginOfTargetMapsToZero) {
    Rng rng(4);
    for (int trial = 0; trial < 1000; ++trial) {
        const Rigid3 cam_from_world = random_motion(rng);
        EXPECT_LT((cam_from_world * cam_from_world.target_origin_in_source()).norm(), 1e-11);
    }
}

TEST(Rigid3, LongChainsStayNormalised) {
    Rng rng(5);
    Rigid3 chain;
    for (int step = 0; step < 100000; ++step) chain = random_motion(rng) * chain;
    EXPECT_NEAR(chain.rotation.norm(), 1.0, 1e-14);
}

TEST(RotationAngle, KnowsSmallAndLargeAngles) {
    const Eigen::Vector3d axis = Eigen::Vector3d(1, -2, 3).normalized();
    for (const double angle :
         {0.0, 1e-12, 1e-7, 0.1, 1.0, 3.0, std::numbers::pi - 1e-9, std::numbers::pi}) {
        const Eigen::Quaterniond rotation(Eigen::AngleAxisd(angle, axis));
        EXPECT_NEAR(rotation_angle(rotation), angle, 1e-15 + 1e-15 * angle) << angle;
    }
}

TEST(RotationAngle, IsTheSameForBothQuaternionsOfARotation) {
    Rng rng(6);
    for (int trial = 0; trial < 1000; ++trial) {
        const Eigen::Quaterniond rotation = rng.rotation();
        const Eigen::Quaterniond negated(-rotation.w(), -rotation.x(), -rotation.y(),
                                         -rotation.z());
        EXPECT_EQ(rotation_angle(rotation), rotation_angle(negated));
        EXPECT_LE(rotation_angle(rotation), std::numbers::pi + 1e-15);
    }
}

TEST(AngleBetween, IsAMetric) {
    Rng rng(7);
    for (int trial = 0; trial < 1000; ++trial) {
        const Eigen::Quaterniond a = rng.rotation();
        const Eigen::Quaterniond b = rng.rotation();
        const Eigen::Quaterniond c = rng.rotation();
        EXPECT_LT(angle_between(a, a), 1e-15);
        EXPECT_NEAR(angle_between(a, b), angle_between(b, a), 1e-14);
        EXPECT_LE(angle_between(a, c), angle_between(a, b) + angle_between(b, c) + 1e-14);
        EXPECT_NEAR(angle_between(c * a, c * b), angle_between(a, b), 1e-13);
    }
}

TEST(RotationBetween, TurnsOneDirectionIntoAnotherByTheirAngle) {
    Rng rng(8);
    for (int trial = 0; trial < 1000; ++trial) {
        const Eigen::Vector3d from =
            rng.uniform(0.1, 10.0) * (rng.rotation() * Eigen::Vector3d::UnitX());
        const Eigen::Vector3d to = rng.rotation() * Eigen::Vector3d::UnitX();
        const Eigen::Quaterniond rotation = rotation_between(from, to);
        EXPECT_LT((rotation * from.normalized() - to).norm(), 1e-12);
        EXPECT_NEAR(rotation_angle(rotation), std::acos(from.normalized().dot(to)), 1e-7);
    }
}

TEST(RotationBetween, TakesDirectionsThatAreAlikeOrOpposite) {
    const Eigen::Vector3d along(1, 2, 3);
    EXPECT_LT(rotation_angle(rotation_between(along, 2.0 * along)), 1e-12);
    for (const double off : {0.0, 1e-14, 1e-11, 1e-9, 1e-7, 1e-4}) {
        const Eigen::Vector3d to = (-along + off * Eigen::Vector3d::UnitX()).normalized();
        const Eigen::Quaterniond rotation = rotation_between(along, to);
        EXPECT_LT((rotation * along.normalized() - to).norm(), 1e-11) << off;
    }
}

}  // namespace
}  // namespace psfm
