// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/solve/reconsider_model.h"

#include <gtest/gtest.h>

#include "tests/stages/reconstruction/problems.h"
#include "tests/stages/reconstruction/two_parts.h"

namespace psfm {
namespace {

/// The true model, looked at where nothing better can be made.
SolveAttempt reconsidered(const TwoParts& parts, std::vector<VerifiedPairPtr> pairs) {
    ClusterProblem problem = problem_of(parts.scene, std::move(pairs));
    problem.concluding = true;
    SolveAttempt attempt;
    attempt.model = synthetic::true_reconstruction(parts.scene, Sim3{});
    auto done = reconsider_model(problem, std::move(attempt), {}, [](const ClusterProblem&) {
        return Result<SolveAttempt>(Error{ErrorCode::kNoSeed, "nothing"});
    });
    EXPECT_TRUE(done.ok());
    return *std::move(done);
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

}  // namespace
}  // namespace psfm
