// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/solve/reconsider_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <set>

#include "tests/stages/reconstruction/problems.h"
#include "tests/stages/reconstruction/two_parts.h"
#include "tests/synthetic/change_points.h"

namespace psfm {
namespace {

/// The true model, looked at where nothing better can be made.
/// @param other  what each other attempt ends with; empty: with nothing
SolveAttempt reconsidered(const TwoParts& parts, std::vector<VerifiedPairPtr> pairs,
                          const Reconstruction& other = {}, const SolveOptions& options = {}) {
    ClusterProblem problem = problem_of(parts.scene, std::move(pairs));
    problem.concluding = true;
    SolveAttempt attempt;
    attempt.model = synthetic::true_reconstruction(parts.scene, Sim3{});
    auto done = reconsider_model(problem, std::move(attempt), options, [&](const ClusterProblem&) {
        if (other.empty()) return Result<SolveAttempt>(Error{ErrorCode::kNoSeed, "nothing"});
        SolveAttempt made;
        made.model = other;
        return Result<SolveAttempt>(std::move(made));
    });
    EXPECT_TRUE(done.ok());
    return *std::move(done);
}

/// The true model but for the joint of its parts: it denies the edge there, and explains a false
/// one.
Reconstruction joined_otherwise(const TwoParts& parts, const VerifiedPair& false_edge) {
    Reconstruction model = synthetic::true_reconstruction(parts.scene, Sim3{});
    std::set<std::pair<ImageId, std::uint32_t>> taken;
    std::vector<ScenePoint> joining;
    for (const FeatureMatch& match : false_edge.geometry.inliers) {
        ScenePoint& point = joining.emplace_back(*model.points.begin());
        point.track = {{false_edge.pair.first, match.first},
                       {false_edge.pair.second, match.second}};
        taken.insert({false_edge.pair.first, match.first});
        taken.insert({false_edge.pair.second, match.second});
    }
    synthetic::change_points(model, [&](std::vector<ScenePoint>& points) {
        std::vector<ScenePoint> halves;
        for (const ScenePoint& point : points) {
            for (const bool left : {true, false}) {
                ScenePoint half = point;
                std::erase_if(half.track, [&](const Observation& seen) {
                    return (index_of(seen.image) < TwoParts::kLeft) != left ||
                           taken.contains({seen.image, seen.feature});
                });
                if (half.track.size() > 1) halves.push_back(std::move(half));
            }
        }
        std::ranges::move(joining, std::back_inserter(halves));
        points = std::move(halves);
    });
    return model;
}

bool is_told(const SolveAttempt& attempt) {
    return attempt.state.weaknesses.has(Weakness::kLookAlikes);
}

TEST(TwoPartsOfAModel, StayTogetherWhereNothingSpeaksAgainstIt) {
    const TwoParts parts;
    const SolveAttempt attempt = reconsidered(parts, parts.pairs(0.3, 0));
    EXPECT_TRUE(attempt.places->empty());
    EXPECT_FALSE(is_told(attempt));
}

TEST(TwoPartsOfAModel, AreKeptApartWhereMoreIsDeniedThanExplained) {
    const TwoParts parts;
    const SolveAttempt attempt = reconsidered(parts, parts.pairs(0.3, 3));
    ASSERT_EQ(attempt.places->size(), 2U);
    EXPECT_EQ(attempt.places->front().size(), TwoParts::kLeft);
    EXPECT_EQ(attempt.places->back().size(), TwoParts::kImages - TwoParts::kLeft);
    EXPECT_EQ(attempt.places->back().front(), ImageId{TwoParts::kLeft});
    EXPECT_TRUE(is_told(attempt));
}

TEST(TwoPartsOfAModel, StayTogetherWhereMuchJoinsThemAndTheDoubtIsTold) {
    const TwoParts parts;
    std::vector<VerifiedPairPtr> pairs = synthetic::make_verified_pairs(parts.scene);
    EXPECT_FALSE(is_told(reconsidered(parts, pairs)));
    pairs.push_back(denied_edge(pairs.front(), {ImageId{3}, ImageId{TwoParts::kLeft}}));
    std::ranges::sort(pairs, {}, [](const VerifiedPairPtr& pair) { return pair->pair; });
    const SolveAttempt attempt = reconsidered(parts, pairs);
    EXPECT_TRUE(attempt.places->empty());
    EXPECT_TRUE(is_told(attempt));
}

TEST(TwoPartsOfAModel, AreKeptApartWhereTheyCouldBelongTogetherInAnotherWay) {
    const TwoParts parts;
    const std::vector<VerifiedPairPtr> pairs = parts.pairs(1.0, 1);
    const auto denied = std::ranges::find(pairs, ImagePair{ImageId{0}, ImageId{11}},
                                          [](const VerifiedPairPtr& pair) { return pair->pair; });
    const Reconstruction other = joined_otherwise(parts, **denied);
    SolveOptions options;
    options.doubt.outweighed = 1000.0;  // the question of another test
    options.doubt.as_well_explained = 0.8;
    const SolveAttempt attempt = reconsidered(parts, pairs, other, options);
    ASSERT_EQ(attempt.places->size(), 2U);
    EXPECT_EQ(attempt.places->front().size(), TwoParts::kLeft);
    EXPECT_EQ(attempt.places->back().front(), ImageId{TwoParts::kLeft});
    EXPECT_TRUE(reconsidered(parts, pairs, {}, options).places->empty()) << "no other model";
}

}  // namespace
}  // namespace psfm
