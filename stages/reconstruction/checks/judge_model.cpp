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
    return due.rotations || contradiction.angle_deg > 1.5 * state.tolerated_contradiction_deg;
}

std::optional<Reset::Reason> reason_to_reset(const SolveAttempt& attempt,
                                             const ClusterProblem& problem,
                                             const SolveOptions& options) {
    const std::size_t placed = attempt.model.images.size();
    const DueQuestions due = plan_solve(problem, attempt.state, placed, options.policy).due;
    if (is_bad_configuration(attempt.contradiction, attempt.state, due, options))
        return Reset::Reason::kContradiction;
    // What was started with few images may stand where the others cannot be reached from.
    if (due.new_start && 4 * placed < 3 * problem.images.size()) return Reset::Reason::kStuck;
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
    if (reason == Reset::Reason::kContradiction) {
        return contradicting_part(fresh) < contradicting_part(old) &&
               5 * size >= 4 * old.model.images.size() &&
               5 * observation_count(fresh.model) >= 4 * observation_count(old.model) &&
               !brings_doubt(fresh.model, old.model, options);
    }
    return size > old.model.images.size() &&
           contradicting_part(fresh) <= options.max_contradicting_edges;
}

}  // namespace psfm
