// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/solve/solve_with_ties.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "stages/reconstruction/checks/judge_ties.h"
#include "stages/reconstruction/model/local_numbers.h"
#include "stages/reconstruction/model/plan_solve.h"

namespace psfm {
namespace {

/// Guard: fewer views hardly determine focal lengths.
constexpr std::size_t kImagesToJudge = 4;

bool has_places(const SolveAttempt& attempt) {
    return attempt.places && !attempt.places->empty();
}

bool is_due(const SolveAttempt& attempt, const ClusterProblem& problem, const SolvePolicy& policy) {
    const std::size_t placed = attempt.model.images.size();
    if (placed < kImagesToJudge || has_places(attempt)) return false;
    return plan_solve(problem, attempt.state, placed, policy).due.ties;
}

/// Solves on from a model whose ties have changed.
Result<SolveAttempt> solve_on(const ClusterProblem& problem, const TieVerdict& verdict,
                              const SolveAttempt& before, const AttemptSolve& attempt_solve) {
    ClusterProblem again = problem;
    again.recycled = {verdict.model};
    again.recycled_state = before.state;
    again.settle = true;
    auto solved = attempt_solve(tied(again, verdict.ties));
    if (!solved.ok()) return solved.error();
    solved->statistics.kind = before.statistics.kind;
    solved->statistics.reset = before.statistics.reset;
    solved->statistics.registered += before.statistics.registered;
    return solved;
}

/// Asks a model whether its ties hold, and solves it on without those that do not.
Result<SolveAttempt> settle_ties(SolveAttempt attempt, CameraTies ties,
                                 const ClusterProblem& problem, const SolveOptions& options,
                                 const AttemptSolve& attempt_solve) {
    // Of one camera? If not, with a camera each; which of these are one; and whether that holds.
    constexpr int kRounds = 3;  // Guard: one for each question
    for (int round = 0; round < kRounds; ++round) {
        const auto model = std::make_shared<const Reconstruction>(attempt.model);
        const TieVerdict verdict = judge_ties(model, problem, ties, options);
        attempt.state.images_at_ties = static_cast<std::uint32_t>(model->images.size());
        if (verdict.ties == ties) break;
        ties = verdict.ties;
        auto solved = solve_on(problem, verdict, attempt, attempt_solve);
        if (!solved.ok()) return solved.error();
        attempt = *std::move(solved);
        attempt.state.images_at_ties = static_cast<std::uint32_t>(attempt.model.images.size());
        attempt.statistics.ties_changed = true;
    }
    return attempt;
}

/// Whether a model that came along has an image of the problem with another camera than it was
/// accepted with.
bool has_foreign_cameras(const ClusterProblem& problem) {
    const LocalNumbers numbers(problem);
    return std::ranges::any_of(problem.recycled, [&](const auto& model) {
        return std::ranges::any_of(model->images, [&](const RegisteredImage& image) {
            const auto local = numbers.find(image.image);
            return local && problem.images[*local].camera != image.camera;
        });
    });
}

bool is_new(const SolveAttempt& attempt) {
    return attempt.statistics.kind == SolveKind::kNew || attempt.statistics.reset.has_value();
}

}  // namespace

Result<SolveAttempt> solve_with_ties(const ClusterProblem& problem, const SolveOptions& options,
                                     const AttemptSolve& attempt_solve) {
    if (problem.alike.empty() || problem.fix_intrinsics) {
        // Models may come from where cameras were tied.
        return attempt_solve(has_foreign_cameras(problem) ? tied(problem, untied(problem))
                                                          : problem);
    }
    CameraTies ties = recycled_ties(problem);  // step 1 of solve_cluster
    auto attempt = attempt_solve(tied(problem, ties));
    if (!attempt.ok() || has_places(*attempt)) return attempt;
    // Lenses that differ much keep images out of a model that has one for all.
    const std::size_t placed = attempt->model.images.size();
    if (is_new(*attempt) && is_stuck(placed, problem, options) && ties != untied(problem)) {
        ClusterProblem apart = problem;
        apart.recycled.clear();
        auto fresh = attempt_solve(apart);
        // Expected: where there is no model with cameras apart, the one with ties stays
        if (!fresh.ok() && fresh.error().code == ErrorCode::kCancelled) return fresh;
        if (fresh.ok() && !has_places(*fresh) && fresh->model.images.size() > placed) {
            fresh->statistics.reset = attempt->statistics.reset;
            attempt = std::move(fresh);
            ties = untied(problem);
        }
    }
    if (!is_due(*attempt, problem, options.policy)) return attempt;
    return settle_ties(*std::move(attempt), std::move(ties), problem, options,
                       attempt_solve);  // step 6
}

}  // namespace psfm
