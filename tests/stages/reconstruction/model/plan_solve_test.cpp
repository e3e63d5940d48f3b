// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/model/plan_solve.h"

#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace psfm {
namespace {

/// Where a solve stands, and what is then to be done with the shipped sizes.
struct Row {
    std::string what;
    std::uint32_t members = 0;
    std::uint32_t placed = 0;  ///< in the recycled model; 0: there is none
    bool settle = false;
    SolveState state = {};
    SolveStart start = SolveStart::kRecycled;
    SolveScope scope = SolveScope::kAll;
    SolveEffort effort = SolveEffort::kConverged;
};

ClusterProblem problem_of(const Row& row) {
    ClusterProblem problem;
    problem.images.resize(row.members);
    problem.settle = row.settle;
    problem.recycled_state = row.state;
    if (row.placed > 0) {
        Reconstruction model;
        model.images.resize(row.placed);
        problem.recycled.push_back(std::make_shared<const Reconstruction>(std::move(model)));
    }
    return problem;
}

SolveState adjusted_with(std::uint32_t images) {
    return {.images_at_full_adjustment = images};
}

TEST(PlanSolve, StartScopeAndEffortFollowFromSizes) {
    using enum SolveStart;
    using enum SolveScope;
    using enum SolveEffort;
    const std::vector<Row> table = {
        {"below mu_min", 2, 0, false, {}, kNone, kAll, kConverged},
        {"mu_min", 3, 0, false, {}, kIncremental, kAll, kConverged},
        {"mu_max", 50, 0, false, {}, kIncremental, kAll, kConverged},
        {"above mu_max", 51, 0, false, {}, kGlobal, kAll, kConverged},
        {"new and large", 501, 0, false, {}, kGlobal, kAll, kRough},
        {"new and very large", 1001, 0, false, {}, kGlobal, kJoint, kRough},
        {"an image more", 100, 99, false, adjusted_with(99), kRecycled, kAll, kConverged},
        {"an image beside many", 201, 200, false, adjusted_with(200), kRecycled, kSurroundings,
         kConverged},
        {"grown by eta_grow", 231, 200, false, adjusted_with(200), kRecycled, kAll, kConverged},
        {"adjusted long ago", 201, 200, false, adjusted_with(174), kRecycled, kAll, kConverged},
        {"beside very many", 1201, 1200, false, adjusted_with(1200), kRecycled, kSurroundings,
         kRough},
        {"grown, very large", 1400, 1200, false, adjusted_with(1200), kRecycled, kJoint, kRough},
        {"images have left it", 240, 200, false, adjusted_with(300), kRecycled, kAll, kConverged},
        {"large, and settles", 201, 200, true, adjusted_with(200), kRecycled, kAll, kConverged},
        {"very large, and settles", 1201, 1200, true, adjusted_with(1200), kRecycled, kAll,
         kConverged},
        {"settles, and has no model", 1001, 0, true, {}, kGlobal, kJoint, kRough},
    };
    for (const Row& row : table) {
        const SolvePlan plan = plan_solve(problem_of(row), SolvePolicy{});
        EXPECT_EQ(plan.start, row.start) << row.what;
        EXPECT_EQ(plan.scope, row.scope) << row.what;
        EXPECT_EQ(plan.effort, row.effort) << row.what;
    }
}

TEST(PlanSolve, WhatIsJoinedBeforeAModelSettlesIsAdjustedByItsSize) {
    const Row row{"", 1201, 1200, true, adjusted_with(1200)};
    const SolvePlan plan = plan_solve(problem_of(row), row.state, 1201, SolvePolicy{});
    EXPECT_EQ(plan.scope, SolveScope::kJoint);
    EXPECT_EQ(plan.effort, SolveEffort::kRough);
}

/// As scheduler/presets/paper.txt sets the sizes.
SolvePolicy without_sizes() {
    constexpr std::uint32_t kNever = std::numeric_limits<std::uint32_t>::max();
    return {.doubt_up_to = 0,
            .large_from = kNever,
            .converge_up_to = kNever,
            .affordable_up_to = kNever};
}

TEST(PlanSolve, OfThePaperNothingDependsOnTheSizeButTheStart) {
    for (const std::uint32_t placed : {5U, 51U, 201U, 501U, 1001U, 100000U}) {
        const Row row{"", placed + 1, placed, false, adjusted_with(placed)};
        const SolvePlan plan = plan_solve(problem_of(row), without_sizes());
        EXPECT_EQ(plan.scope, SolveScope::kAll) << placed;
        EXPECT_EQ(plan.effort, SolveEffort::kConverged) << placed;
        EXPECT_FALSE(plan.due.loops || plan.due.others) << placed;
    }
}

/// What is due once a model of so many images of a cluster is there.
struct Asked {
    std::string what;
    std::uint32_t members = 0;
    std::uint32_t placed = 0;
    bool settle = false;
    bool concluding = false;
    SolveState state = {};
    DueQuestions due = {};
};

/// Everything was asked of this many.
SolveState asked_with(std::uint32_t images) {
    return {.images_at_full_adjustment = images,
            .images_at_contradiction = images,
            .images_at_start = images,
            .images_at_places = images,
            .images_when_reconsidered = images,
            .images_at_ties = images};
}

TEST(PlanSolve, QuestionsAreDueAsTheirObjectGrows) {
    SolveState put_off = asked_with(100);
    put_off.new_start_is_due = true;
    const std::vector<Asked> table = {
        {"never asked",
         20,
         20,
         false,
         false,
         {},
         {.full_adjustment = true,
          .rotations = true,
          .places = true,
          .new_start = true,
          .ties = true,
          .worth = true}},
        {"nothing new", 20, 20, false, false, asked_with(20), {.places = true, .worth = true}},
        {"grown by a quarter",
         25,
         25,
         false,
         false,
         asked_with(20),
         {.full_adjustment = true, .places = true, .worth = true}},
        {"by more",
         26,
         26,
         false,
         false,
         asked_with(20),
         {.full_adjustment = true,
          .rotations = true,
          .places = true,
          .new_start = true,
          .worth = true}},
        {"by more than half",
         31,
         31,
         false,
         false,
         asked_with(20),
         {.full_adjustment = true,
          .rotations = true,
          .places = true,
          .new_start = true,
          .ties = true,
          .worth = true}},
        {"shrunk by half",
         10,
         10,
         false,
         false,
         asked_with(20),
         {.rotations = true, .places = true, .new_start = true, .worth = true}},
        {"a large model", 200, 200, false, false, asked_with(200), {.places = true}},
        {"too large to ask each time", 1001, 1001, false, false, asked_with(1001), {.loops = true}},
        {"grown by a per cent",
         1011,
         1011,
         false,
         false,
         asked_with(1000),
         {.places = true, .loops = true}},
        {"settles",
         1001,
         1001,
         true,
         false,
         asked_with(1001),
         {.places = true, .loops = true, .ties = true, .worth = true}},
        {"settles larger",
         1002,
         1001,
         true,
         false,
         asked_with(1001),
         {.places = true, .loops = true, .new_start = true, .ties = true, .worth = true}},
        {"a new start was put off",
         100,
         100,
         false,
         false,
         put_off,
         {.places = true, .worth = true}},
        {"and is due",
         100,
         100,
         true,
         false,
         put_off,
         {.rotations = true, .places = true, .ties = true, .worth = true}},
        {"no photograph follows",
         21,
         20,
         false,
         true,
         asked_with(20),
         {.places = true, .worth = true, .others = true}},
        {"compared already", 20, 20, false, true, asked_with(20), {.places = true, .worth = true}},
        {"too large to compare",
         151,
         151,
         false,
         true,
         asked_with(150),
         {.places = true, .worth = true}},
    };
    for (const Asked& row : table) {
        ClusterProblem problem;
        problem.images.resize(row.members);
        problem.settle = row.settle;
        problem.concluding = row.concluding;
        const DueQuestions due = plan_solve(problem, row.state, row.placed, SolvePolicy{}).due;
        EXPECT_EQ(due.full_adjustment, row.due.full_adjustment) << row.what;
        EXPECT_EQ(due.rotations, row.due.rotations) << row.what;
        EXPECT_EQ(due.places, row.due.places) << row.what;
        EXPECT_EQ(due.loops, row.due.loops) << row.what;
        EXPECT_EQ(due.new_start, row.due.new_start) << row.what;
        EXPECT_EQ(due.ties, row.due.ties) << row.what;
        EXPECT_EQ(due.worth, row.due.worth) << row.what;
        EXPECT_EQ(due.others, row.due.others) << row.what;
    }
}

TEST(PlanSolve, SizesThatMakeNoSenseAreRefused) {
    EXPECT_TRUE(validate(SolvePolicy{}).ok());
    EXPECT_TRUE(validate(without_sizes()).ok());
    EXPECT_FALSE(validate(SolvePolicy{.mu_min = 1}).ok());
    EXPECT_FALSE(validate(SolvePolicy{.full_adjustment = {0.0}}).ok());
    EXPECT_FALSE(validate(SolvePolicy{.places = {-0.1}}).ok());
}

}  // namespace
}  // namespace psfm
