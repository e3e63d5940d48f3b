// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/checks/judge_model.h"

#include <algorithm>

#include "stages/reconstruction/checks/judged_model.h"

namespace psfm {
namespace {

/// Part of the edges that contradict.
double contradicting_part(const SolveAttempt& attempt) {
    return static_cast<double>(attempt.contradiction.beyond) /
           std::max(1U, attempt.contradiction.edges);
}

std::size_t observation_count(const Reconstruction& model) {
    std::size_t count = 0;
    for (const ScenePoint& point : model.points) count += point.track.size();
    return count;
}

}  // namespace

bool is_bad_configuration(const Contradiction& contradiction, const SolveState& state,
                          const DueQuestions& due, const SolveOptions& options) {
    if (contradiction.angle_deg <= options.max_contradiction_deg) return false;
    return due.rotations ||
           contradiction.angle_deg > options.reset.worse_by * state.tolerated_contradiction_deg;
}

bool is_stuck(std::size_t placed, const ClusterProblem& problem, const SolveOptions& options) {
    return static_cast<double>(placed) <
           options.reset.stuck_below * static_cast<double>(problem.images.size());
}

std::optional<Reset::Reason> reason_to_reset(const SolveAttempt& attempt,
                                             const ClusterProblem& problem,
                                             const SolveOptions& options) {
    const std::size_t placed = attempt.model.images.size();
    const DueQuestions due = plan_solve(problem, attempt.state, placed, options.policy).due;
    if (is_bad_configuration(attempt.contradiction, attempt.state, due, options))
        return Reset::Reason::kContradiction;
    if (due.new_start && is_stuck(placed, problem, options)) return Reset::Reason::kStuck;
    return std::nullopt;
}

bool is_put_off(const SolveAttempt& attempt, const ClusterProblem& problem, Reset::Reason reason,
                const SolveOptions& options) {
    return reason == Reset::Reason::kContradiction && !problem.settle &&
           options.policy.scope_of(problem.images.size()) != SolveScope::kAll &&
           contradicting_part(attempt) <= options.max_contradicting_edges;
}

bool is_better(const SolveAttempt& fresh, const SolveAttempt& old, Reset::Reason reason,
               const SolveOptions& options) {
    const std::size_t size = fresh.model.images.size();
    const auto keeps = [&](std::size_t count, std::size_t before) {
        return static_cast<double>(count) >= options.reset.min_kept * static_cast<double>(before);
    };
    if (reason == Reset::Reason::kContradiction) {
        return contradicting_part(fresh) < contradicting_part(old) &&
               keeps(size, old.model.images.size()) &&
               keeps(observation_count(fresh.model), observation_count(old.model)) &&
               !brings_doubt(fresh.model, old.model, options);
    }
    return size > old.model.images.size() &&
           contradicting_part(fresh) <= options.max_contradicting_edges;
}

}  // namespace psfm
