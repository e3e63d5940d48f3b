// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/evaluation/pose_auc.h"

#include <gtest/gtest.h>

#include <array>

#include "tests/stages/evaluation/pose_lists.h"

namespace psfm {
namespace {

constexpr std::array<double, 4> kLimits{1.0, 3.0, 5.0, 10.0};

TEST(PoseAuc, EqualUpToASimilarityIsOne) {
    const auto reference = test::grid_poses(12, 1);
    const auto model = test::moved(reference, test::some_similarity(1));
    for (const double area : relative_pose_auc(reference, model, kLimits))
        EXPECT_NEAR(area, 1.0, 1e-5);
}

TEST(PoseAuc, MissingImagesAreFailures) {
    const auto reference = test::grid_poses(10, 2);
    auto model = reference;
    model.resize(6);
    for (const double area : relative_pose_auc(reference, model, kLimits)) {
        EXPECT_NEAR(area, (6.0 * 5.0) / (10.0 * 9.0), 1e-6);
    }
}

TEST(PoseAuc, OneTurnedCameraCostsItsPairs) {
    // Two degrees in one of ten cameras: 9 of 45 pairs are off by 2 degrees. A camera turned in
    // place turns the pair's relative rotation, and the direction of translation by at most as
    // much.
    const auto reference = test::grid_poses(10, 3);
    auto model = reference;
    test::turn_in_place(model[4], {1, 2, 3}, 2.0);
    const auto areas = relative_pose_auc(reference, model, kLimits);
    EXPECT_NEAR(areas[0], 36.0 / 45.0, 1e-6);
    EXPECT_NEAR(areas[1], (36.0 + 9.0 * (1.0 - 2.0 / 3.0)) / 45.0, 1e-6);
    EXPECT_NEAR(areas[2], (36.0 + 9.0 * (1.0 - 2.0 / 5.0)) / 45.0, 1e-6);
    EXPECT_NEAR(areas[3], (36.0 + 9.0 * (1.0 - 2.0 / 10.0)) / 45.0, 1e-6);
}

TEST(PoseAuc, DirectionOfTranslationCountsWithItsSign) {
    std::vector<NamedPose> reference;
    const Eigen::Quaterniond upright = Eigen::Quaterniond::Identity();
    reference.push_back(test::pose_at("a", {0, 0, 0}, upright));
    reference.push_back(test::pose_at("b", {1, 0, 0}, upright));
    auto model = reference;
    model[1] = test::pose_at("b", {std::cos(0.02), std::sin(0.02), 0}, upright);  // 1.146 degrees
    EXPECT_NEAR(relative_pose_auc(reference, model, kLimits)[3], 1.0 - 0.02 / test::kRadians / 10.0,
                1e-9);
    model[1] = test::pose_at("b", {-1, 0, 0}, upright);
    EXPECT_EQ(relative_pose_auc(reference, model, kLimits)[3], 0.0);
}

TEST(PoseAuc, CoincidingCentres) {
    const Eigen::Quaterniond upright = Eigen::Quaterniond::Identity();
    const std::vector<NamedPose> together{test::pose_at("a", {1, 2, 3}, upright),
                                          test::pose_at("b", {1, 2, 3}, upright)};
    auto apart = together;
    test::shift_centre(apart[1], {0.5, 0, 0});
    EXPECT_EQ(relative_pose_auc(together, apart, kLimits)[0],
              1.0);  // no direction to be wrong about
    EXPECT_EQ(relative_pose_auc(apart, together, kLimits)[3], 0.0);
}

TEST(PoseAuc, OrderDoesNotMatterAndFewImagesAreFine) {
    const auto reference = test::grid_poses(20, 5);
    auto model = test::moved(reference, test::some_similarity(5));
    for (std::size_t i = 0; i < model.size(); i += 3) test::turn_in_place(model[i], {0, 1, 1}, 0.3);
    const auto areas = relative_pose_auc(reference, model, kLimits);
    synthetic::Rng rng(1);
    rng.shuffle(model);
    EXPECT_EQ(relative_pose_auc(reference, model, kLimits), areas);
    EXPECT_EQ(relative_pose_auc({}, {}, kLimits), std::vector<double>(4, 0.0));
}

}  // namespace
}  // namespace psfm
