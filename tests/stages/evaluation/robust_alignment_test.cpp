// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/evaluation/robust_alignment.h"

#include <gtest/gtest.h>

#include "tests/stages/evaluation/pose_lists.h"

namespace psfm {
namespace {

struct Planted {
    std::vector<Eigen::Vector3d> source;
    std::vector<Eigen::Vector3d> target;
    Sim3 truth;
    std::vector<std::uint32_t> inliers;
};

/// Points of a 20 m cube; the first `outliers` in a random order of the targets are thrown anywhere
/// in it.
Planted plant(std::size_t count, std::size_t outliers, double noise, std::uint64_t seed) {
    synthetic::Rng rng(seed);
    Planted planted;
    planted.truth = test::some_similarity(seed + 1000);
    const auto in_cube = [&] {
        return Eigen::Vector3d(rng.uniform(-10, 10), rng.uniform(-10, 10), rng.uniform(-10, 10));
    };
    for (std::size_t i = 0; i < count; ++i) {
        planted.target.push_back(in_cube());
        planted.source.push_back(inverse(planted.truth) *
                                 (planted.target.back() + noise * rng.normal3()));
    }
    const auto order = synthetic::random_order(count, seed);
    std::vector<bool> wrong(count, false);
    for (std::size_t i = 0; i < outliers; ++i) {
        wrong[order[i]] = true;
        planted.target[order[i]] = in_cube();
    }
    for (std::uint32_t i = 0; i < count; ++i) {
        if (!wrong[i]) planted.inliers.push_back(i);
    }
    return planted;
}

struct Case {
    std::size_t count;
    std::size_t outliers;
};

class PlantedOutliers : public testing::TestWithParam<Case> {};

TEST_P(PlantedOutliers, AreFoundAndDoNotMoveTheFit) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        const Planted planted = plant(GetParam().count, GetParam().outliers, 0.01, seed);
        const auto aligned = align_robustly(planted.source, planted.target, 0.1);
        ASSERT_TRUE(aligned.ok());
        EXPECT_TRUE(aligned->consensus);
        EXPECT_TRUE(std::ranges::includes(aligned->inliers, planted.inliers));
        // A random target lands within 0.1 m of the right one once in two million times.
        EXPECT_EQ(aligned->inliers.size(), planted.inliers.size());
        const Sim3 off = aligned->target_from_source * inverse(planted.truth);
        EXPECT_NEAR(off.scale, 1.0, 0.01);
        EXPECT_LT(rotation_angle(off.rotation), 0.01);
    }
}

INSTANTIATE_TEST_SUITE_P(Shares, PlantedOutliers,
                         testing::Values(Case{5, 0}, Case{8, 3}, Case{11, 6}, Case{30, 20},
                                         Case{33, 22}, Case{100, 75}, Case{1000, 600},
                                         Case{1000, 800}));

TEST(AlignRobustly, ConsistentMinorityLoses) {
    // A third of the cameras agree among themselves, in a wrong place: a folded model.
    Planted planted = plant(60, 0, 0.01, 9);
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitZ()));
    for (std::size_t i = 0; i < 20; ++i) planted.target[i] = turn * planted.target[i];
    const auto aligned = align_robustly(planted.source, planted.target, 0.1);
    ASSERT_TRUE(aligned.ok());
    EXPECT_EQ(aligned->inliers.size(), 40U);
    EXPECT_EQ(aligned->inliers.front(), 20U);
}

TEST(AlignRobustly, WithoutConsensusFitsAll) {
    const Planted planted = plant(10, 10, 0.0, 4);
    const auto aligned = align_robustly(planted.source, planted.target, 1e-6);
    ASSERT_TRUE(aligned.ok());
    EXPECT_FALSE(aligned->consensus);
    EXPECT_EQ(aligned->inliers.size(), 10U);
}

TEST(AlignRobustly, RepeatsItself) {
    const Planted planted = plant(200, 150, 0.02, 12);
    const auto first = align_robustly(planted.source, planted.target, 0.1);
    const auto second = align_robustly(planted.source, planted.target, 0.1);
    EXPECT_EQ(first->inliers, second->inliers);
    EXPECT_EQ(first->target_from_source.translation, second->target_from_source.translation);
}

TEST(AlignRobustly, RefusesBadInput) {
    const Planted planted = plant(10, 0, 0.0, 1);
    const std::span source(planted.source);
    const std::span target(planted.target);
    EXPECT_EQ(align_robustly(source.first(2), target.first(2), 1.0).error().code,
              ErrorCode::kTooFewMatches);
    EXPECT_EQ(align_robustly(source, target, 0.0).error().code, ErrorCode::kInvalidArgument);
    EXPECT_EQ(align_robustly(source, target, std::nan("")).error().code,
              ErrorCode::kInvalidArgument);
    EXPECT_EQ(align_robustly(source, target, 1.0, {.max_triples = 0}).error().code,
              ErrorCode::kInvalidArgument);
    const std::vector<Eigen::Vector3d> collapsed(10, Eigen::Vector3d::Ones());
    EXPECT_EQ(align_robustly(collapsed, target, 1.0).error().code, ErrorCode::kDegenerate);
}

}  // namespace
}  // namespace psfm
