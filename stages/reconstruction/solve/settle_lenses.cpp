// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/solve/settle_lenses.h"

#include <memory>
#include <utility>

#include "stages/reconstruction/checks/judge_lenses.h"
#include "stages/reconstruction/solve/reconsider_model.h"

namespace psfm {

Result<SolveAttempt> settle_lenses(const ClusterProblem& problem, SolveAttempt attempt,
                                   const SolveOptions& options, const AttemptSolve& solve,
                                   const std::atomic<bool>* cancel) {
    const bool has_places = attempt.places && !attempt.places->empty();
    if (!problem.settle || problem.fix_intrinsics || attempt.model.empty() || has_places)
        return attempt;
    ClusterProblem again = problem;
    again.recycled = {std::make_shared<const Reconstruction>(attempt.model)};
    again.recycled_state = attempt.state;
    const CameraTies ties = recycled_ties(again);
    auto judged = judge_lenses(again.recycled.front(), problem, ties, options, cancel);
    if (!judged.ok()) return judged.error();
    if (!*judged) return attempt;
    again.recycled = {*std::move(judged)};
    const auto reconsidered = as_reconsidered(again, options.doubt);
    auto solved = solve(tied(reconsidered ? *reconsidered : again, ties));
    if (!solved.ok()) return solved.error();
    if (solved->model.images.size() < attempt.model.images.size()) return attempt;
    solved->state.images_at_ties = attempt.state.images_at_ties;
    solved->statistics.kind = attempt.statistics.kind;
    solved->statistics.reset = attempt.statistics.reset;
    solved->statistics.ties_changed = attempt.statistics.ties_changed;
    solved->statistics.registered += attempt.statistics.registered;
    solved->succession.reset();
    return solved;
}

}  // namespace psfm
