// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/solve/solve_cluster.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <optional>

#include "stages/reconstruction/build/grow_model.h"
#include "stages/reconstruction/build/initialize_model.h"
#include "stages/reconstruction/build/join_while_growing.h"
#include "stages/reconstruction/build/recycle_models.h"
#include "stages/reconstruction/build/refine_model.h"
#include "stages/reconstruction/build/solve_global.h"
#include "stages/reconstruction/checks/assess_model.h"
#include "stages/reconstruction/checks/contradiction.h"
#include "stages/reconstruction/checks/judge_model.h"
#include "stages/reconstruction/checks/separate_places.h"
#include "stages/reconstruction/model/local_graph.h"
#include "stages/reconstruction/model/tracks.h"
#include "stages/reconstruction/solve/close_loops.h"
#include "stages/reconstruction/solve/extend_locally.h"
#include "stages/reconstruction/solve/mend_model.h"
#include "stages/reconstruction/solve/reconsider_model.h"
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

/// Takes a model over that nothing will change any more.
void finish(SolveAttempt& attempt, const WorkingModel& model, const LocalGraph& graph,
            const SolveOptions& options) {
    attempt.model = model.save();
    attempt.contradiction = find_contradiction(model, graph, options.max_contradiction_deg);
}

/// All images at once (paper sec. "Cluster Reconstruction", New, above mu_max), the rest added.
Result<SolveAttempt> solve_globally(const ClusterProblem& problem, const LocalGraph& graph,
                                    const CorrespondenceGraph& matches, const SolveOptions& options,
                                    const std::atomic<bool>* cancel) {
    WorkingModel model(problem, matches);
    model.use_cameras(graph.cameras);
    const auto start = initialize_globally(model, problem, graph, options, cancel);
    if (!start.ok()) return start.error();
    SolveAttempt attempt;
    attempt.statistics.is_global = true;
    attempt.statistics.registered = start->placed;
    attempt.statistics.full_adjustments = start->full_adjustments;
    attempt.state.images_at_full_adjustment = start->placed;
    const auto grown =
        grow_model(model, problem, options, cancel, attempt.state, attempt.statistics);
    if (!grown.ok()) return grown.error();
    if (model.registered_count() > start->placed) {
        const auto adjustments =
            refine_changed_model(model, problem.fix_intrinsics, options, cancel);
        if (!adjustments.ok()) return adjustments.error();
        attempt.statistics.full_adjustments += *adjustments;
        attempt.state.images_at_full_adjustment = model.registered_count();
    }
    finish(attempt, model, graph, options);
    return attempt;
}

/// Starts from the best pair; from another one when most images stayed out. Keeps the larger model.
Result<SolveAttempt> solve_new(const ClusterProblem& problem, const LocalGraph& graph,
                               const CorrespondenceGraph& matches, const SolveOptions& options,
                               const std::atomic<bool>* cancel) {
    if (problem.images.size() > options.mu_max) {
        auto attempt = solve_globally(problem, graph, matches, options, cancel);
        // What could not be started globally may still be grown.
        if (attempt.ok() || attempt.error().code == ErrorCode::kCancelled) return attempt;
    }
    constexpr int kStarts = 3;  // Tunable: ours, without a figure
    SolveAttempt best;
    std::vector<bool> used(problem.images.size(), false);
    for (int start = 0; start < kStarts; ++start) {
        WorkingModel model(problem, matches);
        model.use_cameras(graph.cameras);
        const auto seed = initialize_model(model, graph, used, options);
        if (!seed.ok()) break;
        SolveAttempt attempt;
        attempt.state.images_at_full_adjustment = model.registered_count();
        attempt.statistics.registered = model.registered_count();
        const auto grown =
            grow_model(model, problem, options, cancel, attempt.state, attempt.statistics);
        if (!grown.ok() && grown.error().code == ErrorCode::kCancelled) return grown.error();
        if (grown.ok() && model.registered_count() > best.model.images.size()) {
            const auto adjustments =
                refine_model(model, problem.fix_intrinsics, options.settling, options, cancel);
            if (!adjustments.ok() && adjustments.error().code == ErrorCode::kCancelled)
                return adjustments.error();
            if (adjustments.ok()) {
                attempt.statistics.full_adjustments += *adjustments;
                attempt.state.images_at_full_adjustment = model.registered_count();
                finish(attempt, model, graph, options);
                best = std::move(attempt);
            }
        }
        if (2 * best.model.images.size() > problem.images.size()) break;
        used[seed->first] = used[seed->second] = true;
        for (std::uint32_t image = 0; image < model.image_count(); ++image) {
            if (model.registered(image)) used[image] = true;
        }
    }
    return best;
}

/// Notes that a model has been asked for places.
void note_asked(SolveState& state, std::size_t images) {
    state.images_at_places = static_cast<std::uint32_t>(images);
    state.has_strangers = false;
}

/// Closes what is open in a model, and notes it.
Result<LoopClosing> close_open_loops(WorkingModel& model, const ClusterProblem& problem,
                                     const LocalGraph& graph, const SolveOptions& options,
                                     const std::atomic<bool>* cancel, SolveAttempt& attempt) {
    const auto closing = close_loops(model, problem, graph, options, cancel);
    if (!closing.ok()) return closing.error();
    attempt.statistics.full_adjustments += closing->adjustments;
    attempt.statistics.closed_loops += closing->adjustments > 0 ? 1 : 0;
    if (closing->shows_one_place) note_asked(attempt.state, model.registered_count());
    return closing;
}

/// Adjusts models that were joined, unless they show different places: what would only come apart
/// again is not adjusted first. @return whether they show one place; else `attempt` is finished
Result<bool> adjust_joint(WorkingModel& model, const Recycling& recycling,
                          const ClusterProblem& problem, const LocalGraph& graph,
                          const SolveOptions& options, const std::atomic<bool>* cancel,
                          SolveAttempt& attempt) {
    complete_tracks(model, recycling.joint, options.tracks);
    merge_tracks(model, recycling.joint, options.tracks);
    const auto closing = close_open_loops(model, problem, graph, options, cancel, attempt);
    if (!closing.ok()) return closing.error();
    if (!closing->shows_one_place) {
        auto places = separate_places(model.save(), pairs_of(problem), options.places);
        if (!places.empty()) {
            finish(attempt, model, graph, options);
            attempt.places = std::move(places);
            attempt.statistics.kind = SolveKind::kTransfer;
            return false;
        }
        note_asked(attempt.state, model.registered_count());
    }
    if (closing->adjustments > 0) {  // what the joint moved has been adjusted
        attempt.state.images_at_full_adjustment = model.registered_count();
        return true;
    }
    const auto joined = static_cast<double>(recycling.images.size());
    if (joined <= options.eta_grow * attempt.state.images_at_full_adjustment) {
        attempt.statistics.local_adjustments +=
            refine_joined_locally(model, recycling.images, problem.fix_intrinsics, options);
        return true;
    }
    const auto adjustments = refine_joined(model, recycling.images, recycling.joint,
                                           problem.fix_intrinsics, options, cancel);
    if (!adjustments.ok()) return adjustments.error();
    attempt.statistics.full_adjustments += *adjustments;
    attempt.state.images_at_full_adjustment = model.registered_count();
    return true;
}

/// Joins what is recycled, adds the other images, places anew the few that contradict, and adjusts.
Result<SolveAttempt> solve_recycled(const ClusterProblem& problem, const LocalGraph& graph,
                                    const CorrespondenceGraph& matches, const SolveOptions& options,
                                    const std::atomic<bool>* cancel) {
    WorkingModel model(problem, matches);
    model.use_cameras(graph.cameras);
    SolveAttempt attempt;
    attempt.state = state_of_recycled(problem);
    attempt.statistics.kind = problem.settle                ? SolveKind::kSettle
                              : problem.recycled.size() > 1 ? SolveKind::kTransfer
                                                            : SolveKind::kExtend;
    const auto handle = [&](const Recycling& recycling) {
        return adjust_joint(model, recycling, problem, graph, options, cancel, attempt);
    };
    const auto grown =
        join_while_growing(model, load_recycled(model, problem, graph, options), problem, graph,
                           options, cancel, handle, attempt.state, attempt.statistics);
    if (!grown.ok()) return grown.error();
    if (attempt.places) return attempt;
    if (is_bad_configuration(find_contradiction(model, graph, options.max_contradiction_deg),
                             model.registered_count(), attempt.state, problem.settle, options)) {
        const auto mended =
            mend_model(model, problem, graph, options, cancel, attempt.state, attempt.statistics);
        if (!mended.ok()) return mended.error();
        attempt.state.images_at_places = 0;  // another model, of as many images
    }
    const auto closing = close_open_loops(model, problem, graph, options, cancel, attempt);
    if (!closing.ok()) return closing.error();
    if (problem.settle) {
        const auto adjustments =
            refine_model(model, problem.fix_intrinsics, options.settling, options, cancel);
        if (!adjustments.ok()) return adjustments.error();
        attempt.statistics.full_adjustments += *adjustments;
        attempt.state.images_at_full_adjustment = model.registered_count();
    }
    finish(attempt, model, graph, options);
    return attempt;
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
/// leaves much of the cluster out.
Result<SolveAttempt> solve_or_reset(const ClusterProblem& problem, const LocalGraph& graph,
                                    const CorrespondenceGraph& matches, const SolveOptions& options,
                                    const std::atomic<bool>* cancel) {
    auto attempt = solve_recycled(problem, graph, matches, options, cancel);
    if (!attempt.ok() || attempt->places) return attempt;
    const auto reason = reason_to_reset(*attempt, problem, options);
    attempt->state.new_start_is_due = reason ? is_put_off(*attempt, problem, *reason, options)
                                             : attempt->state.new_start_is_due && !problem.settle;
    if (!reason) return attempt;
    if (attempt->state.new_start_is_due) {
        note_compared(problem, *reason, *attempt);
        return attempt;
    }
    auto fresh = solve_new(problem, graph, matches, options, cancel);
    if (!fresh.ok()) return fresh;
    if (is_better(*fresh, *attempt, *reason, options)) {
        fresh->statistics.reset = Reset{*reason, attempt->contradiction,
                                        static_cast<std::uint32_t>(attempt->model.images.size())};
        attempt = std::move(fresh);
    }
    note_compared(problem, *reason, *attempt);
    return attempt;
}

/// Adds new images to a large model by what they can change; else solves with all of the cluster.
Result<SolveAttempt> attempt_solve(const ClusterProblem& problem, const SolveOptions& options,
                                   const std::atomic<bool>* cancel) {
    auto extended = extend_locally(problem, options, cancel);
    if (!extended.ok()) return extended.error();
    if (*extended) return **std::move(extended);
    const auto graph = make_local_graph(problem, options);
    if (!graph.ok()) return graph.error();
    const CorrespondenceGraph matches = correspondences_of(problem, *graph);
    auto attempt = problem.recycled.empty()
                       ? solve_new(problem, *graph, matches, options, cancel)
                       : solve_or_reset(problem, *graph, matches, options, cancel);
    if (!attempt.ok()) return attempt;
    if (problem.recycled.empty())
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

/// Asks a finished model for places, or leaves that to a later solve.
void ask_for_places(SolveAttempt& attempt, const ClusterProblem& problem,
                    const SolveOptions& options) {
    if (!problem.settle && was_asked_lately(attempt, options.places)) {
        attempt.places.emplace();
        attempt.state.has_strangers |= attempt.statistics.registered > 0;
        return;
    }
    attempt.places = separate_places(attempt.model, pairs_of(problem), options.places);
    note_asked(attempt.state, attempt.model.images.size());
}

/// Gives up a model whose depth is invented; says of another one what it is worth.
/// @return why its images wait where it was given up
std::optional<WaitReason> assess(SolveAttempt& attempt, const ClusterProblem& problem,
                                 const SolveOptions& options) {
    if (attempt.model.images.size() > options.assessment.assess_up_to && !problem.settle)
        return std::nullopt;
    if (has_invented_depth(attempt.model, pairs_of(problem), options.assessment)) {
        const SolveKind kind = attempt.statistics.kind;
        attempt = SolveAttempt{};
        attempt.statistics.kind = kind;
        attempt.places.emplace();
        return WaitReason::kNoParallax;
    }
    const bool shows_look_alikes = attempt.state.weaknesses.has(Weakness::kLookAlikes) &&
                                   attempt.state.images_when_reconsidered == problem.images.size();
    attempt.state.weaknesses = weaknesses_of(attempt.model, options.assessment);
    if (shows_look_alikes) attempt.state.weaknesses.add(Weakness::kLookAlikes);
    return std::nullopt;
}

Result<ClusterSolution> solve(const ClusterProblem& problem, const SolveOptions& options,
                              const std::atomic<bool>* cancel) {
    ClusterSolution solution;
    solution.cluster = problem.cluster;
    solution.topology = problem.topology;
    SolveAttempt attempt;
    WaitReason reason = WaitReason::kClusterTooSmall;
    if (problem.images.size() < options.mu_min) {
        attempt.statistics.kind = SolveKind::kTooSmall;
    } else {
        const AttemptSolve solve_once = [&](const ClusterProblem& posed) {
            return solve_with_ties(posed, options, [&](const ClusterProblem& tied) {
                return attempt_solve(tied, options, cancel);
            });
        };
        const auto reconsidered = as_reconsidered(problem);
        auto attempted = solve_once(reconsidered ? *reconsidered : problem);
        if (attempted.ok() && problem.concluding)
            attempted = reconsider_model(problem, *std::move(attempted), options, solve_once);
        if (!attempted.ok()) return attempted.error();
        attempt = *std::move(attempted);
        reason = assess(attempt, problem, options).value_or(WaitReason::kNoSeed);
    }
    attempt.statistics.mean_error_px = mean_error_px(attempt.model);
    solution.waiting = waiting_images(problem, attempt.model, reason);
    if (!attempt.places) ask_for_places(attempt, problem, options);
    solution.places = *std::move(attempt.places);
    solution.model = std::make_shared<const Reconstruction>(std::move(attempt.model));
    solution.succession = std::move(attempt.succession);
    solution.state = attempt.state;
    solution.statistics = attempt.statistics;
    return solution;
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
