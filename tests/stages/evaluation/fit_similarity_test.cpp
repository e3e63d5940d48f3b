// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/evaluation/fit_similarity.h"

#include <gtest/gtest.h>

#include "tests/stages/evaluation/pose_lists.h"

namespace psfm {
namespace {

std::vector<Eigen::Vector3d> random_points(std::size_t count, std::uint64_t seed) {
    synthetic::Rng rng(seed);
    std::vector<Eigen::Vector3d> points;
    for (std::size_t i = 0; i < count; ++i) points.push_back(rng.normal3());
    return points;
}

std::vector<Eigen::Vector3d> images_of(const Sim3& similarity,
                                       const std::vector<Eigen::Vector3d>& points) {
    std::vector<Eigen::Vector3d> result;
    for (const Eigen::Vector3d& point : points) result.push_back(similarity * point);
    return result;
}

TEST(FitSimilarity, RecoversPlantedSimilarity) {
    for (std::uint64_t seed = 1; seed <= 50; ++seed) {
        const auto source = random_points(3 + seed % 5, seed);
        const Sim3 truth = test::some_similarity(seed);
        const auto fit = fit_similarity(source, images_of(truth, source));
        ASSERT_TRUE(fit.ok());
        EXPECT_FALSE(fit->collinear);
        EXPECT_NEAR(fit->target_from_source.scale / truth.scale, 1.0, 1e-9);
        EXPECT_LT(angle_between(fit->target_from_source.rotation, truth.rotation), 1e-7);
        EXPECT_LT((fit->target_from_source.translation - truth.translation).norm(), 1e-8);
    }
}

TEST(FitSimilarity, MirrorImageIsNotFittedByAReflection) {
    const auto source = random_points(20, 7);
    auto target = source;
    for (Eigen::Vector3d& point : target) point.x() = -point.x();
    const auto fit = fit_similarity(source, target);
    ASSERT_TRUE(fit.ok());
    const double determinant = fit->target_from_source.rotation.toRotationMatrix().determinant();
    EXPECT_NEAR(determinant, 1.0, 1e-12);
    double residual = 0.0;
    for (std::size_t i = 0; i < source.size(); ++i) {
        residual += (fit->target_from_source * source[i] - target[i]).norm();
    }
    EXPECT_GT(residual, 1.0);
}

TEST(FitSimilarity, NoSmallStepFromTheFitIsBetter) {
    synthetic::Rng rng(3);
    const auto source = random_points(12, 11);
    auto target = images_of(test::some_similarity(5), source);
    for (Eigen::Vector3d& point : target) point += 0.3 * rng.normal3();
    const auto cost = [&](const Sim3& similarity) {
        double sum = 0.0;
        for (std::size_t i = 0; i < source.size(); ++i) {
            sum += (similarity * source[i] - target[i]).squaredNorm();
        }
        return sum;
    };
    const Sim3 best = fit_similarity(source, target)->target_from_source;
    for (int trial = 0; trial < 200; ++trial) {
        const Sim3 step{1.0 + 1e-3 * rng.normal(), rng.small_rotation(1e-3), 1e-3 * rng.normal3()};
        EXPECT_GE(cost(step * best), cost(best));
    }
}

TEST(FitSimilarity, LineIsFittedAndSaidSo) {
    std::vector<Eigen::Vector3d> source;
    for (int i = 0; i < 6; ++i) source.emplace_back(i, 2.0 * i, -0.5 * i);
    const auto target = images_of(test::some_similarity(2), source);
    const auto fit = fit_similarity(source, target);
    ASSERT_TRUE(fit.ok());
    EXPECT_TRUE(fit->collinear);
    for (std::size_t i = 0; i < source.size(); ++i) {
        EXPECT_LT((fit->target_from_source * source[i] - target[i]).norm(), 1e-9);
    }
}

TEST(FitSimilarity, RefusesWhatDeterminesNothing) {
    const std::vector<Eigen::Vector3d> one{Eigen::Vector3d::Zero()};
    EXPECT_EQ(fit_similarity(one, one).error().code, ErrorCode::kTooFewMatches);
    const std::vector<Eigen::Vector3d> same(4, Eigen::Vector3d(1e6, 2e6, 3e6) / 3.0);
    const auto spread = random_points(4, 1);
    EXPECT_EQ(fit_similarity(same, spread).error().code, ErrorCode::kDegenerate);
    EXPECT_EQ(fit_similarity(spread, same).error().code, ErrorCode::kDegenerate);
    EXPECT_EQ(fit_similarity(spread, random_points(5, 1)).error().code, ErrorCode::kTooFewMatches);
}

}  // namespace
}  // namespace psfm
