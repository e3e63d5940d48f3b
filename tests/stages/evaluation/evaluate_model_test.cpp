// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/evaluation/evaluate_model.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "tests/stages/evaluation/pose_lists.h"

namespace psfm {
namespace {

using test::grid_poses;
using test::moved;
using test::pose_at;
using test::some_similarity;

double diagonal(const std::vector<NamedPose>& poses) {
    Eigen::AlignedBox3d box;
    for (const NamedPose& pose : poses) box.extend(pose.cam_from_world.target_origin_in_source());
    return box.diagonal().norm();
}

TEST(EvaluateModel, TruthInAnotherGaugeHasNoError) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        const auto reference = grid_poses(3 + 4 * seed, seed);
        const auto evaluation = evaluate_model(reference, moved(reference, some_similarity(seed)));
        ASSERT_TRUE(evaluation.ok());
        EXPECT_EQ(evaluation->registered, reference.size());
        EXPECT_EQ(evaluation->images.size(), reference.size());
        EXPECT_LT(evaluation->position_rms, 1e-9);
        EXPECT_LT(evaluation->rotation_max_deg, 1e-5);
        EXPECT_EQ(evaluation->outliers, 0U);
    }
}

TEST(EvaluateModel, PlantedErrorsAreMeasuredAsPlanted) {
    // 30 cameras; four thrown off by 3, 4, 5 and 6 m, one turned by 7 degrees, one by 20: the
    // inliers are exact, so the alignment is, and every figure is known beforehand.
    const auto reference = grid_poses(30, 3);
    auto model = reference;
    test::shift_centre(model[2], {3, 0, 0});
    test::shift_centre(model[9], {0, 0, 4});
    test::shift_centre(model[17], {3, -4, 0});
    test::shift_centre(model[28], {0, -6, 0});
    test::turn_in_place(model[5], {1, 1, 0}, 7.0);
    test::turn_in_place(model[6], {0, 1, -1}, 20.0);
    const auto evaluation = evaluate_model(reference, moved(model, some_similarity(8)));
    ASSERT_TRUE(evaluation.ok());
    EXPECT_EQ(evaluation->outliers, 4U);
    EXPECT_NEAR(evaluation->position_mean, (3.0 + 4.0 + 5.0 + 6.0) / 30.0, 1e-9);
    EXPECT_NEAR(evaluation->position_median, 0.0, 1e-9);
    EXPECT_NEAR(evaluation->position_rms, std::sqrt((9.0 + 16.0 + 25.0 + 36.0) / 30.0), 1e-9);
    EXPECT_NEAR(evaluation->position_relative, evaluation->position_rms / diagonal(reference),
                1e-12);
    EXPECT_NEAR(evaluation->rotation_max_deg, 20.0, 1e-6);
    EXPECT_NEAR(evaluation->rotation_median_deg, 0.0, 1e-5);
    EXPECT_TRUE(evaluation->images[17].outlier);
    EXPECT_NEAR(evaluation->images[17].position, 5.0, 1e-9);
    EXPECT_NEAR(evaluation->images[5].rotation_deg, 7.0, 1e-6);
}

TEST(EvaluateModel, NoiseHasTheExpectedSize) {
    // Least squares takes up 7 of the 3 N degrees of freedom: sum of squares = (3 N - 7) sigma^2.
    constexpr double kSigma = 0.01;
    constexpr std::size_t kCount = 200;
    double sum_of_squares = 0.0;
    constexpr int kTrials = 20;
    for (std::uint64_t seed = 1; seed <= kTrials; ++seed) {
        synthetic::Rng rng(seed);
        const auto reference = grid_poses(kCount, seed);
        auto model = reference;
        for (NamedPose& pose : model) test::shift_centre(pose, kSigma * rng.normal3());
        const auto evaluation = evaluate_model(reference, moved(model, some_similarity(seed)));
        ASSERT_TRUE(evaluation.ok());
        EXPECT_EQ(evaluation->outliers, 0U);
        sum_of_squares += evaluation->position_rms * evaluation->position_rms * kCount;
    }
    const double expected = kTrials * (3.0 * kCount - 7.0) * kSigma * kSigma;
    EXPECT_NEAR(sum_of_squares / expected, 1.0, 0.04);  // 3 standard deviations: 3 sqrt(2 / 11860)
}

TEST(EvaluateModel, ImagesNotInTheReferenceAreCountedOnly) {
    const auto all = grid_poses(20, 4);
    const std::vector<NamedPose> reference(all.begin(), all.begin() + 12);
    const auto evaluation = evaluate_model(reference, all);
    ASSERT_TRUE(evaluation.ok());
    EXPECT_EQ(evaluation->registered, 20U);
    EXPECT_EQ(evaluation->images.size(), 12U);
    EXPECT_NEAR(evaluation->position_rms, 0.0, 1e-9);
}

TEST(EvaluateModel, RelativeErrorTakesTheWholeReference) {
    const auto reference = grid_poses(35, 6);
    std::vector<NamedPose> part(reference.begin(), reference.begin() + 6);
    test::shift_centre(part[0], {0, 1, 0});
    const auto evaluation = evaluate_model(reference, part);
    ASSERT_TRUE(evaluation.ok());
    EXPECT_NEAR(evaluation->position_relative, std::sqrt(1.0 / 6.0) / diagonal(reference), 1e-9);
}

TEST(EvaluateModel, OrderOfTheListsDoesNotMatter) {
    auto reference = grid_poses(80, 7);
    auto model = moved(reference, some_similarity(7));
    synthetic::Rng rng(7);
    for (std::size_t i = 0; i < model.size(); i += 2)
        test::shift_centre(model[i], 5.0 * rng.normal3());
    const auto first = evaluate_model(reference, model);
    ASSERT_TRUE(first.ok());
    for (int shuffle = 0; shuffle < 3; ++shuffle) {
        rng.shuffle(reference);
        rng.shuffle(model);
        const auto second = evaluate_model(reference, model);
        ASSERT_TRUE(second.ok());
        EXPECT_EQ(second->outliers, first->outliers);
        EXPECT_EQ(second->position_mean, first->position_mean);
        EXPECT_EQ(second->rotation_median_deg, first->rotation_median_deg);
    }
}

TEST(EvaluateModel, FoldedRingHasTheFoldedCamerasAsOutliers) {
    // A ring of 120 cameras; 30 of them placed a sixth of a turn further on.
    std::vector<NamedPose> reference;
    std::vector<NamedPose> model;
    for (std::size_t i = 0; i < 120; ++i) {
        const auto on_ring = [&](double angle_deg) {
            const double angle = angle_deg * test::kRadians;
            return pose_at(test::numbered_name(i), {std::cos(angle), std::sin(angle), 0},
                           Eigen::Quaterniond(Eigen::AngleAxisd(-angle, Eigen::Vector3d::UnitZ())));
        };
        reference.push_back(on_ring(3.0 * static_cast<double>(i)));
        model.push_back(on_ring(3.0 * static_cast<double>(i) + (i >= 90 ? 60.0 : 0.0)));
    }
    const auto evaluation = evaluate_model(reference, moved(model, some_similarity(1)));
    ASSERT_TRUE(evaluation.ok());
    EXPECT_EQ(evaluation->outliers, 30U);
    EXPECT_NEAR(evaluation->images[95].position, 1.0, 1e-6);  // chord of 60 degrees
    EXPECT_NEAR(evaluation->rotation_max_deg, 60.0, 1e-5);
}

TEST(EvaluateModel, CamerasInALineAreTurnedByTheirOrientations) {
    synthetic::Rng rng(2);
    std::vector<NamedPose> reference;
    for (std::size_t i = 0; i < 9; ++i) {
        const auto step = static_cast<double>(i);
        reference.push_back(
            pose_at(test::numbered_name(i), {step, 2.0 * step, 0.0}, rng.rotation()));
    }
    auto model = moved(reference, some_similarity(3));
    const auto evaluation = evaluate_model(reference, model);
    ASSERT_TRUE(evaluation.ok());
    EXPECT_LT(evaluation->position_rms, 1e-9);
    EXPECT_LT(evaluation->rotation_max_deg, 1e-5);
    test::turn_in_place(model[3], {1, 0, 0}, 12.0);
    EXPECT_LT(evaluate_model(reference, model)->rotation_max_deg, 13.5);
}

TEST(EvaluateModel, TooLittleInCommonIsSaid) {
    const auto reference = grid_poses(10, 1);
    const std::vector<NamedPose> two(reference.begin(), reference.begin() + 2);
    const auto evaluation = evaluate_model(reference, two);
    ASSERT_FALSE(evaluation.ok());
    EXPECT_EQ(evaluation.error().code, ErrorCode::kTooFewMatches);
    EXPECT_NE(evaluation.error().message.find("only 2 of the model's 2 images"), std::string::npos);
    EXPECT_EQ(evaluate_model(reference, {}).error().code, ErrorCode::kTooFewMatches);
    EXPECT_EQ(evaluate_model({}, reference).error().code, ErrorCode::kTooFewMatches);
    const std::vector<NamedPose> three(reference.begin(), reference.begin() + 3);
    EXPECT_TRUE(evaluate_model(reference, three).ok());
}

TEST(EvaluateModel, CollapsedModelIsDegenerate) {
    const auto reference = grid_poses(10, 1);
    auto model = reference;
    for (NamedPose& pose : model) pose.cam_from_world.translation.setZero();
    EXPECT_EQ(evaluate_model(reference, model).error().code, ErrorCode::kDegenerate);
    EXPECT_EQ(evaluate_model(model, reference).error().code, ErrorCode::kDegenerate);
}

TEST(OutlierThreshold, IsHalfTheSmallestDistance) {
    const Eigen::Quaterniond upright = Eigen::Quaterniond::Identity();
    const std::vector<NamedPose> reference{
        pose_at("a", {0, 0, 0}, upright), pose_at("b", {2, 0, 0}, upright),
        pose_at("c", {2, 3, 0}, upright), pose_at("d", {9, 9, 9}, upright)};
    EXPECT_DOUBLE_EQ(*outlier_threshold(reference, {}), 1.0);
}

TEST(OutlierThreshold, HasAFloorWhereTwoCamerasNearlyCoincide) {
    // Nearest neighbours: 0.01, 0.01, 1.99, 3 -> median 1 -> smallest distance taken as 0.25.
    const Eigen::Quaterniond upright = Eigen::Quaterniond::Identity();
    const std::vector<NamedPose> reference{
        pose_at("a", {0, 0, 0}, upright), pose_at("b", {0.01, 0, 0}, upright),
        pose_at("c", {2, 0, 0}, upright), pose_at("d", {2, 3, 0}, upright)};
    EXPECT_DOUBLE_EQ(*outlier_threshold(reference, {}), 0.5 * 0.25 * (0.5 * (0.01 + 1.99)));
    EXPECT_DOUBLE_EQ(*outlier_threshold(reference, {.min_spacing_ratio = 0.0}), 0.005);
    EXPECT_EQ(outlier_threshold(reference, {.min_spacing_ratio = -1.0}).error().code,
              ErrorCode::kInvalidArgument);
    const std::vector<NamedPose> one_place(5, reference[0]);
    EXPECT_EQ(outlier_threshold(one_place, {}).error().code, ErrorCode::kDegenerate);
}

TEST(SummedOutliers, EachModelIsAlignedByItself) {
    const auto reference = grid_poses(40, 9);
    std::vector<std::vector<NamedPose>> models;
    models.emplace_back(reference.begin(), reference.begin() + 20);
    models.emplace_back(reference.begin() + 20, reference.begin() + 32);
    models.emplace_back(reference.begin() + 32, reference.begin() + 36);  // too small to count
    test::shift_centre(models[0][3], {0, 4, 0});
    test::shift_centre(models[1][0], {0, 4, 0});
    test::shift_centre(models[1][7], {5, 0, 0});
    test::shift_centre(models[2][0], {5, 0, 0});
    for (std::size_t i = 0; i < models.size(); ++i)
        models[i] = moved(models[i], some_similarity(i));
    EXPECT_EQ(*summed_outliers(reference, models), 3U);
    EXPECT_EQ(*summed_outliers(reference, {}), 0U);

    std::vector<NamedPose> collapsed(reference.begin() + 32, reference.end());
    for (NamedPose& pose : collapsed) pose.cam_from_world.translation.setZero();
    models.push_back(collapsed);
    EXPECT_EQ(*summed_outliers(reference, models), 3U + 8U);
    models.push_back({pose_at("x", {0, 0, 0}, Eigen::Quaterniond::Identity())});
    models.back().resize(6, models.back()[0]);
    for (std::size_t i = 0; i < 6; ++i) models.back()[i].name = "unknown" + std::to_string(i);
    EXPECT_EQ(*summed_outliers(reference, models), 3U + 8U);
}

}  // namespace
}  // namespace psfm
