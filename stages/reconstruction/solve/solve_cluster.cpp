// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/solve/solve_cluster.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <optional>

#include "stages/reconstruction/checks/assess_model.h"
#include "stages/reconstruction/checks/judge_model.h"
#include "stages/reconstruction/checks/separate_places.h"
#include "stages/reconstruction/model/local_graph.h"
#include "stages/reconstruction/model/plan_solve.h"
#include "stages/reconstruction/solve/extend_locally.h"
#include "stages/reconstruction/solve/finish_attempt.h"
#include "stages/reconstruction/solve/left_out.h"
#include "stages/reconstruction/solve/reconsider_model.h"
#include "stages/reconstruction/solve/settle_lenses.h"
#include "stages/reconstruction/solve/solve_new.h"
#include "stages/reconstruction/solve/solve_recycled.h"
#include "stages/reconstruction/solve/solve_with_ties.h"

namespace psfm {
namespace {

Result<void> check_problem(const ClusterProblem& problem) {
    for (std::size_t i = 0; i < problem.images.size(); ++i) {
        const ClusterImage& image = problem.images[i];
        if (i > 0 && !(problem.images[i - 1].id < image.id)) {
            return Error{ErrorCode::kInvalidArgument, "cluster problem: images are not ascending"};
        }
        if (!image.keypoints || !problem.cameras.contains(image.camera)) {
            return Error{ErrorCode::kInvalidArgument,
                         "cluster problem: an image lacks its features or its camera"};
        }
    }
    return {};
}

/// Notes that a recycled model has been compared with a new one, or is to be when it settles.
void note_compared(const ClusterProblem& problem, Reset::Reason reason, SolveAttempt& attempt) {
    SolveState& state = attempt.state;
    state.images_at_start = static_cast<std::uint32_t>(problem.images.size());
    if (reason != Reset::Reason::kContradiction) return;
    state.tolerated_contradiction_deg = attempt.contradiction.angle_deg;
    state.images_at_contradiction = static_cast<std::uint32_t>(attempt.model.images.size());
}

/// Extends what is recycled, or solves new when the result contradicts the averaged rotations or
/// leaves much of the cluster out: steps 4 and 5.
Result<SolveAttempt> solve_or_reset(const SolveContext& context,
                                    const CorrespondenceGraph& matches) {
    const ClusterProblem& problem = context.problem;
    auto attempt = solve_recycled(context, matches);  // 4
    if (!attempt.ok() || attempt->places) return attempt;
    const auto reason = reason_to_reset(*attempt, problem, context.options);  // 5
    attempt->state.new_start_is_due = reason
                                          ? is_put_off(*attempt, problem, *reason, context.options)
                                          : attempt->state.new_start_is_due && !problem.settle;
    if (!reason) return attempt;
    if (attempt->state.new_start_is_due) {
        note_compared(problem, *reason, *attempt);
        return attempt;
    }
    auto fresh = solve_new(new_start_of(problem, context.options.policy), context, matches);
    if (!fresh.ok()) return fresh.error();
    if (is_better(*fresh, *attempt, *reason, context.options)) {
        fresh->statistics.reset = Reset{*reason, attempt->contradiction,
                                        static_cast<std::uint32_t>(attempt->model.images.size())};
        attempt = std::move(fresh);
    }
    note_compared(problem, *reason, *attempt);
    return attempt;
}

/// Steps 2 to 5 of solve_cluster.
Result<SolveAttempt> attempt_solve(const ClusterProblem& problem, const SolveOptions& options,
                                   const std::atomic<bool>* cancel) {
    const SolvePlan plan = plan_solve(problem, options.policy);  // 2
    if (plan.scope == SolveScope::kSurroundings) {
        auto extended = extend_locally(problem, options, cancel);
        if (!extended.ok()) return extended.error();
        if (*extended) return **std::move(extended);
    }
    const auto graph = make_local_graph(problem, options);  // 3
    if (!graph.ok()) return graph.error();
    const CorrespondenceGraph matches = correspondences_of(problem, *graph);
    const SolveContext context{problem, *graph, options, cancel};
    // 4 and 5: what is new has nothing to be compared with.
    auto attempt = plan.start == SolveStart::kRecycled ? solve_or_reset(context, matches)
                                                       : solve_new(plan.start, context, matches);
    if (!attempt.ok()) return attempt.error();
    if (plan.start != SolveStart::kRecycled)
        attempt->state.images_at_start = static_cast<std::uint32_t>(problem.images.size());
    attempt->statistics.removed_edges = graph->removed_edges;
    return attempt;
}

std::vector<std::pair<ImageId, WaitReason>> waiting_images(const ClusterProblem& problem,
                                                           const Reconstruction& model,
                                                           WaitReason if_no_model) {
    std::vector<std::pair<ImageId, WaitReason>> waiting;
    auto placed = model.images.begin();  // both ascend
    for (const ClusterImage& image : problem.images) {
        while (placed != model.images.end() && placed->image < image.id) ++placed;
        if (placed != model.images.end() && placed->image == image.id) continue;
        waiting.emplace_back(image.id,
                             model.empty() ? if_no_model : WaitReason::kRegistrationFailed);
    }
    return waiting;
}

double mean_error_px(const Reconstruction& model) {
    double sum = 0.0;
    for (const PointBlockPtr& block : model.points.blocks()) sum += block->sum_error_px();
    return model.points.empty() ? 0.0 : sum / static_cast<double>(model.points.size());
}

DueQuestions due_now(const SolveAttempt& attempt, const ClusterProblem& problem,
                     const SolveOptions& options) {
    return plan_solve(problem, attempt.state, attempt.model.images.size(), options.policy).due;
}

/// Asks a finished model for places, or leaves that to a later solve.
void ask_for_places(SolveAttempt& attempt, const ClusterProblem& problem,
                    const SolveOptions& options) {
    if (!due_now(attempt, problem, options).places) {
        attempt.places.emplace();
        attempt.state.has_strangers |= attempt.statistics.registered > 0;
        return;
    }
    attempt.places = separate_places(attempt.model, pairs_of(problem), options.places);
    note_asked_for_places(attempt.state, attempt.model.images.size());
}

/// Why a model is none, and its images wait.
std::optional<WaitReason> reason_to_give_up(const SolveAttempt& attempt,
                                            const ClusterProblem& problem,
                                            const SolveOptions& options) {
    constexpr std::size_t kFewest = 3;  // Guard: nothing contradicts what two images show
    const std::size_t placed = attempt.model.images.size();
    if (placed > 0 && placed < kFewest) return WaitReason::kNoSeed;
    if (due_now(attempt, problem, options).worth &&
        has_invented_depth(attempt.model, pairs_of(problem), options.assessment))
        return WaitReason::kNoParallax;
    return std::nullopt;
}

/// Gives up a model of too few images, or whose depth is invented; says of another one what it is
/// worth.
/// @return why its images wait where it was given up
std::optional<WaitReason> assess(SolveAttempt& attempt, const ClusterProblem& problem,
                                 const SolveOptions& options) {
    if (const auto reason = reason_to_give_up(attempt, problem, options)) {
        const SolveKind kind = attempt.statistics.kind;
        attempt = SolveAttempt{};
        attempt.statistics.kind = kind;
        attempt.places.emplace();
        return reason;
    }
    if (!due_now(attempt, problem, options).worth) return std::nullopt;
    const bool shows_look_alikes = attempt.state.weaknesses.has(Weakness::kLookAlikes) &&
                                   attempt.state.images_when_reconsidered == problem.images.size();
    attempt.state.weaknesses = weaknesses_of(attempt.model, options.assessment);
    if (shows_look_alikes) attempt.state.weaknesses.add(Weakness::kLookAlikes);
    return std::nullopt;
}

ClusterSolution solution_of(SolveAttempt attempt, const ClusterProblem& problem,
                            WaitReason if_no_model) {
    ClusterSolution solution;
    solution.cluster = problem.cluster;
    solution.topology = problem.topology;
    solution.waiting = waiting_images(problem, attempt.model, if_no_model);
    attempt.statistics.mean_error_px = mean_error_px(attempt.model);
    solution.places = *std::move(attempt.places);
    solution.model = std::make_shared<const Reconstruction>(std::move(attempt.model));
    solution.succession = std::move(attempt.succession);
    solution.state = attempt.state;
    solution.statistics = attempt.statistics;
    return solution;
}

Result<ClusterSolution> solve(const ClusterProblem& problem, const SolveOptions& options,
                              const std::atomic<bool>* cancel) {
    if (plan_solve(problem, options.policy).start == SolveStart::kNone) {
        SolveAttempt none;
        none.statistics.kind = SolveKind::kTooSmall;
        none.places.emplace();
        return solution_of(std::move(none), problem, WaitReason::kClusterTooSmall);
    }
    const AttemptSolve solve_tied = [&](const ClusterProblem& tied) {
        return attempt_solve(tied, options, cancel);
    };
    const AttemptSolve solve_once = [&](const ClusterProblem& posed) {
        return solve_with_ties(posed, options, solve_tied);
    };
    const auto reconsidered = as_reconsidered(problem, options.doubt);
    auto attempt = solve_once(reconsidered ? *reconsidered : problem);  // 1, and 6 around 2 to 5
    if (attempt.ok() && problem.concluding)
        attempt = reconsider_model(problem, *std::move(attempt), options, solve_once);  // 7
    if (attempt.ok())
        attempt = settle_lenses(problem, *std::move(attempt), options, solve_tied, cancel);  // 8
    if (!attempt.ok()) return attempt.error();
    const WaitReason reason =
        assess(*attempt, problem, options).value_or(WaitReason::kNoSeed);  // 9
    if (!attempt->places) ask_for_places(*attempt, problem, options);      // 10
    if (attempt->places->empty()) {                                        // 11
        auto places = places_of_left_out(problem, *attempt, options, solve_once);
        if (!places.ok()) return places.error();
        attempt->places = *std::move(places);
    }
    return solution_of(*std::move(attempt), problem, reason);
}

}  // namespace

const char* name_of(SolveKind kind) {
    switch (kind) {
        case SolveKind::kTooSmall:
            return "too small";
        case SolveKind::kNew:
            return "new";
        case SolveKind::kExtend:
            return "extend";
        case SolveKind::kTransfer:
            return "transfer";
        case SolveKind::kSettle:
            return "settle";
    }
    return "unknown";
}

Result<ClusterSolution> solve_cluster(const ClusterProblem& problem, const SolveOptions& options,
                                      const std::atomic<bool>* cancel) {
    if (const auto valid = validate(options); !valid.ok()) return valid.error();
    if (const auto valid = check_problem(problem); !valid.ok()) return valid.error();
    const auto start = std::chrono::steady_clock::now();
    try {
        auto solution = solve(problem, options, cancel);
        if (solution.ok()) {
            const std::chrono::duration<double, std::milli> elapsed =
                std::chrono::steady_clock::now() - start;
            solution->statistics.milliseconds = elapsed.count();
        }
        return solution;
    } catch (const std::exception& exception) {
        return Error{ErrorCode::kInternal, std::string("cluster solve: ") + exception.what()};
    }
}

}  // namespace psfm
