// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/model/plan_solve.h"

#include <algorithm>

namespace psfm {
namespace {

SolveStart start_of(const ClusterProblem& problem, const SolvePolicy& policy) {
    if (!policy.makes_model(problem.images.size())) return SolveStart::kNone;
    return problem.recycled.empty() ? new_start_of(problem, policy) : SolveStart::kRecycled;
}

DueQuestions due_questions(const ClusterProblem& problem, const SolveState& state,
                           std::size_t placed, const SolvePolicy& policy) {
    const std::size_t members = problem.images.size();
    const Schedule settling{};  // whatever has grown at all
    const Schedule& new_start = problem.settle ? settling : policy.new_start;
    DueQuestions due;
    due.full_adjustment = placed > state.images_at_full_adjustment &&
                          policy.full_adjustment.is_due(placed, state.images_at_full_adjustment);
    due.rotations = (problem.settle && state.new_start_is_due) ||
                    policy.rotations.is_due(placed, state.images_at_contradiction);
    due.places = problem.settle || policy.is_affordable(placed) ||
                 policy.places.is_due(placed, state.images_at_places);
    due.loops = !policy.is_affordable(placed);
    due.new_start = new_start.is_due(members, state.images_at_start);
    due.ties = problem.settle || policy.ties.is_due(placed, state.images_at_ties);
    due.worth = problem.settle || !policy.is_large(placed);
    due.others = problem.concluding && policy.may_be_doubted(members) &&
                 state.images_when_reconsidered != members;
    return due;
}

}  // namespace

SolvePlan plan_solve(const ClusterProblem& problem, const SolveState& state, std::size_t placed,
                     const SolvePolicy& policy) {
    SolvePlan plan;
    plan.start = start_of(problem, policy);
    plan.scope = policy.scope_of(placed);
    plan.effort = policy.effort_of(placed);
    plan.due = due_questions(problem, state, placed, policy);
    return plan;
}

SolvePlan plan_solve(const ClusterProblem& problem, const SolvePolicy& policy) {
    if (problem.recycled.empty())
        return plan_solve(problem, problem.recycled_state, problem.images.size(), policy);
    const std::size_t placed = problem.recycled.front()->images.size();
    const SolveState state = state_of_recycled(problem);
    SolvePlan plan = plan_solve(problem, state, placed, policy);
    if (plan.start != SolveStart::kRecycled) return plan;
    const bool is_due_for_all =
        policy.full_adjustment.is_due(problem.images.size(), state.images_at_full_adjustment);
    if (problem.settle) {
        plan.scope = SolveScope::kAll;
        plan.effort = SolveEffort::kConverged;
    } else if (policy.is_large(placed) && !is_due_for_all) {
        plan.scope = SolveScope::kSurroundings;
    }
    return plan;
}

SolveStart new_start_of(const ClusterProblem& problem, const SolvePolicy& policy) {
    return problem.images.size() > policy.mu_max ? SolveStart::kGlobal : SolveStart::kIncremental;
}

SolveState state_of_recycled(const ClusterProblem& problem) {
    SolveState state = problem.recycled_state;
    const auto images = static_cast<std::uint32_t>(problem.recycled.front()->images.size());
    state.images_at_full_adjustment = std::min(state.images_at_full_adjustment, images);
    return state;
}

}  // namespace psfm
