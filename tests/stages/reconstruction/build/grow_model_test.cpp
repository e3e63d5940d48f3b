// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/build/grow_model.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <set>
#include <vector>

#include "stages/reconstruction/solve/solve_cluster.h"
#include "tests/stages/reconstruction/problems.h"
#include "tests/synthetic/compare.h"
#include "tests/synthetic/disturb.h"
#include "tests/synthetic/verified_pairs.h"

namespace psfm {
namespace {

using synthetic::SyntheticScene;

constexpr ImageId kLastButOne{10};
constexpr ImageId kLast{11};

/// The feature of an image in a match of a pair that it is part of.
std::uint32_t feature_in(const ImagePair& pair, ImageId image, const FeatureMatch& match) {
    return pair.first == image ? match.first : match.second;
}

bool has(const ImagePair& pair, ImageId image) {
    return pair.first == image || pair.second == image;
}

/// A ring whose last image shares its features with the last but one alone, and that one few with
/// all others: when it is placed, `seen_by_last` points are seen by the last one.
std::vector<VerifiedPairPtr> thin_chain(const SyntheticScene& scene, std::size_t seen_by_last) {
    constexpr std::size_t kShared = 26;
    std::set<std::uint32_t> shared;  // features of the last but one that others may have
    std::set<std::uint32_t> seen;    // those of them that the last one has as well
    std::vector<VerifiedPairPtr> pairs;
    for (const VerifiedPairPtr& pair : synthetic::make_verified_pairs(scene)) {
        if (has(pair->pair, kLastButOne) && has(pair->pair, kLast)) {
            for (const FeatureMatch& match : pair->geometry.inliers) {
                if (seen.size() < seen_by_last)
                    seen.insert(feature_in(pair->pair, kLastButOne, match));
            }
        }
    }
    shared = seen;
    for (const VerifiedPairPtr& pair : synthetic::make_verified_pairs(scene)) {
        if (!has(pair->pair, kLastButOne) || has(pair->pair, kLast)) continue;
        for (const FeatureMatch& match : pair->geometry.inliers) {
            if (shared.size() < kShared) shared.insert(feature_in(pair->pair, kLastButOne, match));
        }
    }
    for (const VerifiedPairPtr& pair : synthetic::make_verified_pairs(scene)) {
        const bool of_last = has(pair->pair, kLast);
        if (of_last && !has(pair->pair, kLastButOne)) continue;
        VerifiedPair thinned = *pair;
        if (has(pair->pair, kLastButOne)) {
            std::erase_if(thinned.geometry.inliers, [&](const FeatureMatch& match) {
                const std::uint32_t feature = feature_in(pair->pair, kLastButOne, match);
                return of_last ? shared.contains(feature) && !seen.contains(feature)
                               : !shared.contains(feature);
            });
        }
        pairs.push_back(std::make_shared<const VerifiedPair>(std::move(thinned)));
    }
    return pairs;
}

TEST(GrowModel, AnImageThatSeesFewPointsIsPlacedWhereStructureConfirmsIt) {
    const SyntheticScene scene = synthetic::add_pixel_noise(
        synthetic::make_scene(synthetic::ring_around_sphere(12), 1), 0.3, 2);
    ClusterProblem problem = problem_of(scene, thin_chain(scene, 14));
    problem.fix_intrinsics = true;
    SolveOptions options;
    const auto solution = solve_cluster(problem, options);
    ASSERT_TRUE(solution.ok());
    EXPECT_EQ(solution->model->images.size(), 12U);
    const auto error = synthetic::compare_with_truth(*solution->model, scene);
    ASSERT_TRUE(error.ok());
    EXPECT_LT(error->max_position, 0.1);  // of a ring of 8 m radius

    options.few_points.min_points = 0;
    const auto without = solve_cluster(problem, options);
    ASSERT_TRUE(without.ok());
    EXPECT_EQ(without->model->images.size(), 11U);
}

TEST(GrowModel, FewerPointsThanThatAreNoPose) {
    const SyntheticScene scene = synthetic::add_pixel_noise(
        synthetic::make_scene(synthetic::ring_around_sphere(12), 1), 0.3, 2);
    ClusterProblem problem = problem_of(scene, thin_chain(scene, 6));
    problem.fix_intrinsics = true;
    const auto solution = solve_cluster(problem, {});
    ASSERT_TRUE(solution.ok());
    EXPECT_EQ(solution->model->images.size(), 11U);
    ASSERT_EQ(solution->waiting.size(), 1U);
    EXPECT_EQ(solution->waiting.front().first, kLast);
}

}  // namespace
}  // namespace psfm
