// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/solve/reconsider_model.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "stages/reconstruction/checks/judged_model.h"
#include "stages/reconstruction/checks/model_cuts.h"
#include "stages/reconstruction/checks/rival_models.h"
#include "stages/reconstruction/model/plan_solve.h"

namespace psfm {
namespace {

/// The cluster with its model in two parts, and without the edges that held them together.
ClusterProblem taken_apart(const ClusterProblem& problem, const Judged& judged, const Cut& cut,
                           const DoubtOptions& options) {
    constexpr std::size_t kSmallestPart = 3;  // Guard: fewer are no model to join
    const Reconstruction& model = judged.attempt.model;
    ClusterProblem apart = problem;
    apart.settle = false;
    for (const ModelEdge& edge : judged.edges) {
        if (edge.is_explained(options) && cut.side[edge.first] != cut.side[edge.second])
            apart.view_graph.remove_edge(edge.pair->pair.first, edge.pair->pair.second);
    }
    apart.recycled.clear();
    for (const std::vector<ImageId>& part : parts_of(model, cut)) {
        if (part.size() < kSmallestPart) continue;
        apart.recycled.push_back(
            std::make_shared<const Reconstruction>(restricted_to(model, part)));
    }
    apart.recycled_state = judged.attempt.state;
    return apart;
}

/// The cluster without the edges that a model denies.
ClusterProblem without_denied(const ClusterProblem& problem, const Reconstruction& model,
                              const DoubtOptions& options) {
    ClusterProblem believed = problem;
    for (const ModelEdge& edge : edges_of(model, problem, {}, options)) {
        if (edge.is_denied(options))
            believed.view_graph.remove_edge(edge.pair->pair.first, edge.pair->pair.second);
    }
    return believed;
}

/// A model that comes apart.
struct InParts {
    Judged judged;
    ModelScore whole;  ///< as one
};

/// The search for a better model.
struct Search {
    const ClusterProblem& problem;
    const SolveOptions& options;
    const AttemptSolve& solve;
    Judged best;                      ///< so far
    std::vector<OtherModel> others;   ///< all that were looked at
    std::optional<InParts> in_parts;  ///< the best one of those best ones that came apart
    std::optional<Judged> ahead;      ///< the one tried in this round that misses least
};

/// The best model with its parts kept apart, where they contradict each other.
std::optional<InParts> best_in_parts(const Search& search) {
    const Judged& best = search.best;
    auto apart = in_parts(best, cuts_of(best, search.options.doubt), search.options);
    if (!apart) return std::nullopt;
    return InParts{*std::move(apart), best.score};
}

/// A model is the best one now.
void note_best(Search& search, Judged best) {
    search.best = std::move(best);
    auto apart = best_in_parts(search);
    if (!apart) return;
    if (!search.in_parts ||
        is_better(apart->judged.score, search.in_parts->judged.score, search.options.doubt))
        search.in_parts = std::move(apart);
}

/// Looks at another model. One that could not be made is none. @errors kCancelled
Result<void> offer(Search& search, const ClusterProblem& posed) {
    auto other = search.solve(posed);
    if (!other.ok()) {
        // Expected: a cluster of fewer edges may have no model
        if (other.error().code == ErrorCode::kCancelled) return other.error();
        return {};
    }
    Judged judged = judge(*std::move(other), search.problem, search.options);
    search.others.push_back({judged.score, judged.edges});
    const bool is_complete = judged.score.images >= search.best.score.images;
    if (is_better(judged.score, search.best.score, search.options.doubt)) note_best(search, judged);
    if (is_complete &&
        (!search.ahead || judged.score.missing_part() < search.ahead->score.missing_part()))
        search.ahead = std::move(judged);
    return {};
}

/// From a start afresh, and from the parts of the best model, as long as it gets better.
/// @errors kCancelled
Result<void> look_for_others(Search& search) {
    const DoubtOptions& options = search.options.doubt;
    ClusterProblem fresh = search.problem;
    fresh.recycled.clear();
    fresh.settle = false;
    if (const auto done = offer(search, fresh); !done.ok()) return done.error();
    Judged from = search.best;
    std::set<std::vector<std::vector<ImageId>>> tried;
    for (std::uint32_t round = 0; round < options.max_rounds && from.score.is_doubted(); ++round) {
        const ModelScore before_round = search.best.score;
        search.ahead.reset();
        for (const Cut& cut : cuts_to_try(from, options)) {
            if (!tried.insert(parts_of(from.attempt.model, cut)).second) continue;
            const auto done = offer(search, taken_apart(search.problem, from, cut, options));
            if (!done.ok()) return done.error();
        }
        // The way to a better model may lead over one that is only a little better.
        if (search.best.score != before_round)
            from = search.best;
        else if (search.ahead && search.ahead->score.missing_part() < from.score.missing_part())
            from = *std::move(search.ahead);
        else
            break;
    }
    return {};
}

/// Adjusts the best model to convergence. @errors those of the solve
Result<void> settle_best(Search& search) {
    const Judged& best = search.best;
    ClusterProblem settling =
        without_denied(search.problem, best.attempt.model, search.options.doubt);
    settling.recycled = {std::make_shared<const Reconstruction>(best.attempt.model)};
    settling.recycled_state = best.attempt.state;
    auto settled = search.solve(settling);
    if (!settled.ok()) return settled.error();
    search.best = judge(*std::move(settled), search.problem, search.options);
    return {};
}

/// Ends with parts where the best model comes apart, or another one did that is better so.
/// @return the score of the chosen model as one
ModelScore choose_parts(Search& search) {
    auto chosen = best_in_parts(search);
    const ModelScore best = chosen ? chosen->judged.score : search.best.score;
    if (search.in_parts && is_better(search.in_parts->judged.score, best, search.options.doubt))
        chosen = std::move(search.in_parts);
    if (!chosen) return best;
    search.best = std::move(chosen->judged);
    return chosen->whole;
}

/// Which images of the best model are to be kept apart.
std::vector<std::vector<ImageId>> places_of(const Search& search, const std::vector<Cut>& cuts) {
    const Judged& best = search.best;
    if (best.score.in_places) return *best.attempt.places;
    auto outweighed = outweighed_parts(best, cuts, search.options);
    if (!outweighed.empty()) return outweighed;
    auto common = parts_in_common(best, search.others, search.options.doubt);
    const bool is_model = !common.empty() && search.options.policy.makes_model(common[0].size());
    if (!is_model) common.clear();
    return common;
}

}  // namespace

std::optional<ClusterProblem> as_reconsidered(const ClusterProblem& problem,
                                              const DoubtOptions& options) {
    const bool is_known = problem.concluding && problem.recycled.size() == 1 &&
                          problem.recycled_state.images_when_reconsidered == problem.images.size();
    if (!is_known) return std::nullopt;
    return without_denied(problem, *problem.recycled.front(), options);
}

Result<SolveAttempt> reconsider_model(const ClusterProblem& problem, SolveAttempt attempt,
                                      const SolveOptions& options, const AttemptSolve& solve) {
    const DueQuestions due =
        plan_solve(problem, attempt.state, attempt.model.images.size(), options.policy).due;
    if (attempt.model.empty() || !due.others) return attempt;
    const auto images = static_cast<std::uint32_t>(problem.images.size());
    const auto before = static_cast<std::uint32_t>(attempt.model.images.size());
    const SolveKind kind = attempt.statistics.kind;
    Search search{problem, options, solve, {}, {}, {}, {}};
    note_best(search, judge(std::move(attempt), problem, options));
    const ModelScore asked = search.best.score;
    search.others.push_back({asked, search.best.edges});
    if (asked.is_doubted()) {
        if (const auto done = look_for_others(search); !done.ok()) return done.error();
    }
    if (problem.settle && search.best.score != asked) {
        if (const auto done = settle_best(search); !done.ok()) return done.error();
    }
    const bool is_changed = choose_parts(search) != asked;
    const std::vector<Cut> cuts = cuts_of(search.best, options.doubt);
    std::vector<std::vector<ImageId>> places = places_of(search, cuts);
    SolveAttempt result = std::move(search.best.attempt);
    result.places = std::move(places);
    result.state.images_when_reconsidered = images;
    result.statistics.kind = kind;
    if (is_changed) {
        result.succession.reset();
        result.statistics.reset = Reset{Reset::Reason::kMissing, {}, before};
    }
    if (is_doubtful(cuts, options.doubt)) result.state.weaknesses.add(Weakness::kLookAlikes);
    return result;
}

}  // namespace psfm
