// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/checks/judge_model.h"

#include <gtest/gtest.h>

#include "tests/stages/reconstruction/two_streets.h"
#include "tests/synthetic/change_points.h"
#include "tests/synthetic/verified_pairs.h"

namespace psfm {
namespace {

/// A model of so many images, each with ten observations, and of edges that contradict.
SolveAttempt attempt_of(std::uint32_t images, std::uint32_t edges, std::uint32_t beyond) {
    SolveAttempt attempt;
    attempt.model.cameras.emplace(CameraId{0}, Camera{});
    ScenePoint point;
    for (std::uint32_t i = 0; i < images; ++i) {
        attempt.model.images.push_back({ImageId{i}, CameraId{0}, {}});
        point.track.push_back({ImageId{i}, 0});
    }
    attempt.model.points = std::vector<ScenePoint>(10, point);
    attempt.contradiction.angle_deg = beyond > 0 ? 60.0 : 2.0;
    attempt.contradiction.edges = edges;
    attempt.contradiction.beyond = beyond;
    return attempt;
}

ClusterProblem cluster_of(std::uint32_t images) {
    ClusterProblem problem;
    problem.images.resize(images);
    return problem;
}

TEST(ReasonToReset, IsAContradictionThatWasNotLookedAtBefore) {
    SolveAttempt attempt = attempt_of(20, 100, 10);
    EXPECT_EQ(reason_to_reset(attempt, cluster_of(20), {}), Reset::Reason::kContradiction);
    attempt.state.tolerated_contradiction_deg = 60.0;
    attempt.state.images_at_contradiction = 16;
    EXPECT_EQ(reason_to_reset(attempt, cluster_of(20), {}), std::nullopt);
    attempt.state.images_at_contradiction = 15;
    EXPECT_EQ(reason_to_reset(attempt, cluster_of(20), {}), Reset::Reason::kContradiction);
    attempt.state.images_at_contradiction = 16;
    attempt.contradiction.angle_deg = 91.0;
    EXPECT_EQ(reason_to_reset(attempt, cluster_of(20), {}), Reset::Reason::kContradiction);
}

TEST(ReasonToReset, IsWhatWasPutOffOnceTheModelSettles) {
    SolveAttempt attempt = attempt_of(20, 100, 2);
    attempt.state.tolerated_contradiction_deg = 60.0;
    attempt.state.images_at_contradiction = 20;
    attempt.state.new_start_is_due = true;
    ClusterProblem problem = cluster_of(20);
    EXPECT_EQ(reason_to_reset(attempt, problem, {}), std::nullopt);
    problem.settle = true;
    EXPECT_EQ(reason_to_reset(attempt, problem, {}), Reset::Reason::kContradiction);
    attempt.contradiction.angle_deg = 2.0;
    EXPECT_EQ(reason_to_reset(attempt, problem, {}), std::nullopt) << "mended meanwhile";
}

TEST(IsPutOff, OfALargeModelThatHardlyContradicts) {
    constexpr auto kReason = Reset::Reason::kContradiction;
    SolveOptions options;
    options.policy.affordable_up_to = 20;
    const SolveAttempt attempt = attempt_of(20, 100, 2);
    EXPECT_TRUE(is_put_off(attempt, cluster_of(21), kReason, options));
    EXPECT_FALSE(is_put_off(attempt, cluster_of(20), kReason, options)) << "started soon enough";
    EXPECT_FALSE(is_put_off(attempt_of(20, 100, 3), cluster_of(21), kReason, options));
    EXPECT_FALSE(is_put_off(attempt, cluster_of(21), Reset::Reason::kStuck, options))
        << "images wait for it";
    ClusterProblem settling = cluster_of(21);
    settling.settle = true;
    EXPECT_FALSE(is_put_off(attempt, settling, kReason, options));
}

TEST(ReasonToReset, IsAClusterThatGrewAndStayedOut) {
    SolveAttempt attempt = attempt_of(14, 100, 0);
    attempt.state.images_at_start = 16;
    EXPECT_EQ(reason_to_reset(attempt, cluster_of(21), {}), Reset::Reason::kStuck);
    EXPECT_EQ(reason_to_reset(attempt, cluster_of(20), {}), std::nullopt) << "hardly larger";
    EXPECT_EQ(reason_to_reset(attempt_of(16, 100, 0), cluster_of(21), {}), std::nullopt)
        << "three quarters are in";
    ClusterProblem settling = cluster_of(20);
    settling.settle = true;
    EXPECT_EQ(reason_to_reset(attempt, settling, {}), Reset::Reason::kStuck);
}

TEST(IsBetter, InPlaceOfABadModelContradictsLessAndExplainsAsMuch) {
    constexpr auto kReason = Reset::Reason::kContradiction;
    const SolveAttempt old = attempt_of(20, 100, 10);
    EXPECT_TRUE(is_better(attempt_of(20, 100, 9), old, kReason, {}));
    EXPECT_FALSE(is_better(attempt_of(20, 100, 10), old, kReason, {}));
    EXPECT_FALSE(is_better(attempt_of(20, 50, 9), old, kReason, {})) << "of half the edges";
    EXPECT_TRUE(is_better(attempt_of(16, 100, 0), old, kReason, {}));
    EXPECT_FALSE(is_better(attempt_of(15, 100, 0), old, kReason, {})) << "loses images";
    SolveAttempt ruin = attempt_of(20, 100, 0);
    synthetic::change_points(ruin.model, [](auto& points) { points.resize(8); });
    EXPECT_TRUE(is_better(ruin, old, kReason, {}));
    synthetic::change_points(ruin.model, [](auto& points) { points.resize(7); });
    EXPECT_FALSE(is_better(ruin, old, kReason, {})) << "loses structure";
}

TEST(IsBetter, InPlaceOfABadModelBringsNoDoubt) {
    constexpr auto kReason = Reset::Reason::kContradiction;
    const auto showing = [](const synthetic::SyntheticScene& scene, std::uint32_t beyond) {
        SolveAttempt attempt = attempt_of(40, 100, beyond);
        attempt.model = synthetic::true_reconstruction(scene, {});
        return attempt;
    };
    const auto street = synthetic::make_scene(synthetic::line_along_wall(40), 1);
    const auto folded = two_streets(40, 0.4, 2);
    EXPECT_TRUE(is_better(showing(folded, 9), showing(folded, 10), kReason, {}));
    EXPECT_FALSE(is_better(showing(folded, 9), showing(street, 10), kReason, {}));
}

TEST(IsBetter, InPlaceOfAStuckModelIsLargerAndAgrees) {
    constexpr auto kReason = Reset::Reason::kStuck;
    const SolveAttempt old = attempt_of(10, 100, 0);
    EXPECT_TRUE(is_better(attempt_of(11, 100, 2), old, kReason, {}));
    EXPECT_FALSE(is_better(attempt_of(11, 100, 3), old, kReason, {}));
    EXPECT_FALSE(is_better(attempt_of(10, 100, 0), old, kReason, {}));
}

TEST(ResetOptions, DecideWhenAModelGivesWay) {
    SolveOptions options;
    SolveAttempt worse = attempt_of(20, 100, 10);
    worse.state.tolerated_contradiction_deg = 60.0;
    worse.state.images_at_contradiction = 20;
    worse.contradiction.angle_deg = 91.0;
    EXPECT_TRUE(reason_to_reset(worse, cluster_of(20), options));
    options.reset.worse_by = 2.0;
    EXPECT_FALSE(reason_to_reset(worse, cluster_of(20), options));

    EXPECT_TRUE(is_stuck(14, cluster_of(20), options));
    EXPECT_FALSE(is_stuck(15, cluster_of(20), options));
    options.reset.stuck_below = 0.6;
    EXPECT_FALSE(is_stuck(14, cluster_of(20), options));

    constexpr auto kReason = Reset::Reason::kContradiction;
    const SolveAttempt old = attempt_of(20, 100, 10);
    EXPECT_FALSE(is_better(attempt_of(15, 100, 0), old, kReason, options));
    options.reset.min_kept = 0.7;
    EXPECT_TRUE(is_better(attempt_of(15, 100, 0), old, kReason, options));
}

}  // namespace
}  // namespace psfm
