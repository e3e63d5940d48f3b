// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/solve/reconsider_model.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "stages/algorithms/math/maximum_spanning_tree.h"
#include "stages/reconstruction/checks/judged_model.h"
#include "stages/reconstruction/model/plan_solve.h"

namespace psfm {
namespace {

/// Where a model is taken apart.
struct Cut {
    std::vector<std::uint8_t> side;  ///< by position in the model: 0 or 1
    std::uint32_t images = 0;        ///< on the smaller side
    // Squares of the relative matches of edges across.
    double denied = 0.0;
    double explained = 0.0;
    // Of compared pairs across.
    std::uint32_t regions = 0;
    std::uint32_t missing = 0;
    std::uint32_t contradicting = 0;

    double missing_part() const { return static_cast<double>(missing) / std::max(1U, regions); }
    /// How much of what speaks against the model lies across.
    double promise() const { return denied + missing * missing_part(); }
    /// How strong another explanation is, over the model's.
    double contest() const { return denied / explained; }
};

/// The side of each image when one edge of a tree is taken out.
std::vector<std::uint8_t> sides(std::size_t images, const std::vector<const ModelEdge*>& tree,
                                const ModelEdge* without) {
    std::vector<std::vector<std::uint32_t>> neighbors(images);
    for (const ModelEdge* edge : tree) {
        if (edge == without) continue;
        neighbors[edge->first].push_back(edge->second);
        neighbors[edge->second].push_back(edge->first);
    }
    std::vector<std::uint8_t> side(images, 0);
    std::vector<std::uint32_t> open{without->second};
    side[without->second] = 1;
    while (!open.empty()) {
        const std::uint32_t image = open.back();
        open.pop_back();
        for (const std::uint32_t next : neighbors[image]) {
            if (side[next] != 0) continue;
            side[next] = 1;
            open.push_back(next);
        }
    }
    return side;
}

/// The strongest tree of what a model explains.
std::vector<const ModelEdge*> tree_of(const Judged& judged, const DoubtOptions& options) {
    std::vector<WeightedEdge> weighted;
    std::vector<const ModelEdge*> explained;
    for (const ModelEdge& edge : judged.edges) {
        if (!edge.is_explained(options)) continue;
        weighted.push_back({edge.first, edge.second, edge.weight});
        explained.push_back(&edge);
    }
    const auto images = static_cast<std::uint32_t>(judged.attempt.model.images.size());
    std::vector<const ModelEdge*> tree;
    for (const std::uint32_t index : maximum_spanning_forest(weighted, images))
        tree.push_back(explained[index]);
    return tree;
}

/// Cuts through one edge each of that tree.
std::vector<Cut> cuts_of(const Judged& judged, const DoubtOptions& options) {
    const std::size_t images = judged.attempt.model.images.size();
    const std::vector<const ModelEdge*> tree = tree_of(judged, options);
    std::vector<Cut> cuts;
    cuts.reserve(tree.size());
    for (const ModelEdge* edge : tree) {
        Cut& cut = cuts.emplace_back();
        cut.side = sides(images, tree, edge);
        const auto on_one = static_cast<std::size_t>(std::ranges::count(cut.side, 1));
        cut.images = static_cast<std::uint32_t>(std::min(on_one, images - on_one));
        const auto is_across = [&](const auto& pair) {
            return cut.side[pair.first] != cut.side[pair.second];
        };
        for (const ModelEdge& other : judged.edges) {
            if (!is_across(other)) continue;
            if (other.is_denied(options)) cut.denied += other.relative * other.relative;
            if (other.is_explained(options)) cut.explained += other.relative * other.relative;
        }
        for (const ComparedPair& pair : judged.compared) {
            if (!is_across(pair)) continue;
            cut.regions += pair.regions;
            cut.missing += pair.missing;
            cut.contradicting += contradicts(pair, options) ? 1 : 0;
        }
    }
    return cuts;
}

/// The most promising ones: much is missing across, and edges that the model denies are there to
/// join the parts in another way.
std::vector<Cut> cuts_to_try(const Judged& judged, const DoubtOptions& options) {
    std::vector<Cut> cuts = cuts_of(judged, options);
    std::erase_if(cuts, [](const Cut& cut) { return cut.denied == 0.0; });
    std::ranges::stable_sort(cuts, std::ranges::greater(), &Cut::promise);
    if (cuts.size() > options.max_cuts) cuts.resize(options.max_cuts);
    return cuts;
}

std::vector<std::vector<ImageId>> parts_of(const Reconstruction& model, const Cut& cut) {
    std::vector<std::vector<ImageId>> parts(2);
    for (std::size_t i = 0; i < model.images.size(); ++i)
        parts[cut.side[i]].push_back(model.images[i].image);
    std::ranges::stable_sort(parts, std::ranges::greater(),
                             [](const std::vector<ImageId>& part) { return part.size(); });
    return parts;
}

/// Two parts of a model that contradict each other, and that nothing joins better.
bool contradict_each_other(const Cut& cut, const SolveOptions& options) {
    return options.policy.makes_model(cut.images) &&
           cut.contradicting >= options.doubt.min_split_pairs &&
           cut.missing_part() >= options.doubt.min_split_part;
}

/// Two parts that hang together by less than what speaks for another way.
bool are_outweighed(const Cut& cut, std::size_t images, const SolveOptions& options) {
    return options.policy.makes_model(images - cut.images) && cut.explained < options.doubt.thin &&
           cut.contest() >= options.doubt.outweighed;
}

/// The parts of a model of which it is not known how they belong together. Nothing: there are none.
std::vector<std::vector<ImageId>> split(const Judged& judged, const std::vector<Cut>& cuts,
                                        const SolveOptions& options) {
    const std::size_t images = judged.attempt.model.images.size();
    const auto most = [&](const auto& is_meant, const auto& measure) {
        const Cut* best = nullptr;
        for (const Cut& cut : cuts) {
            if (is_meant(cut) && (best == nullptr || measure(cut) > measure(*best))) best = &cut;
        }
        return best;
    };
    const Cut* cut = most([&](const Cut& c) { return contradict_each_other(c, options); },
                          [](const Cut& c) { return c.missing_part(); });
    if (cut == nullptr) {
        cut = most([&](const Cut& c) { return are_outweighed(c, images, options); },
                   [](const Cut& c) { return c.contest(); });
    }
    if (cut == nullptr) return {};
    return parts_of(judged.attempt.model, *cut);
}

/// Whether two things that look alike may be one in the model, or one of them two: its images
/// should see what they do not, or there is another explanation of how its parts belong together.
bool is_doubtful(const std::vector<Cut>& cuts, const DoubtOptions& options) {
    return std::ranges::any_of(cuts, [&](const Cut& cut) {
        return cut.contradicting >= options.min_split_pairs || cut.contest() >= options.contested;
    });
}

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

/// A step of the search.
struct Step {
    Judged best;                  ///< so far
    std::optional<Judged> ahead;  ///< the one tried in this round that misses least
};

/// Looks at another model. One that could not be made is none. @errors kCancelled
Result<void> offer(Step& step, Result<SolveAttempt> other, const ClusterProblem& problem,
                   const SolveOptions& options) {
    if (!other.ok()) {
        if (other.error().code == ErrorCode::kCancelled) return other.error();
        return {};
    }
    Judged judged = judge(*std::move(other), problem, options);
    const bool is_complete = judged.score.images >= step.best.score.images;
    if (is_better(judged.score, step.best.score, options.doubt)) step.best = judged;
    if (is_complete &&
        (!step.ahead || judged.score.missing_part() < step.ahead->score.missing_part()))
        step.ahead = std::move(judged);
    return {};
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
    Step step{judge(std::move(attempt), problem, options), std::nullopt};
    const ModelScore asked = step.best.score;
    if (is_doubted(step.best)) {
        ClusterProblem fresh = problem;
        fresh.recycled.clear();
        fresh.settle = false;
        if (const auto done = offer(step, solve(fresh), problem, options); !done.ok())
            return done.error();
    }
    Judged from = step.best;
    std::set<std::vector<std::vector<ImageId>>> tried;
    for (std::uint32_t round = 0; round < options.doubt.max_rounds && is_doubted(from); ++round) {
        const ModelScore before_round = step.best.score;
        step.ahead.reset();
        for (const Cut& cut : cuts_to_try(from, options.doubt)) {
            if (!tried.insert(parts_of(from.attempt.model, cut)).second) continue;
            const auto done = offer(step, solve(taken_apart(problem, from, cut, options.doubt)),
                                    problem, options);
            if (!done.ok()) return done.error();
        }
        // The way to a better model may lead over one that is only a little better.
        if (step.best.score != before_round)
            from = step.best;
        else if (step.ahead && step.ahead->score.missing_part() < from.score.missing_part())
            from = *std::move(step.ahead);
        else
            break;
    }
    if (problem.settle && step.best.score != asked) {
        ClusterProblem settling = without_denied(problem, step.best.attempt.model, options.doubt);
        settling.recycled = {std::make_shared<const Reconstruction>(step.best.attempt.model)};
        settling.recycled_state = step.best.attempt.state;
        auto settled = solve(settling);
        if (!settled.ok()) return settled.error();
        step.best = judge(*std::move(settled), problem, options);
    }
    const std::vector<Cut> cuts = cuts_of(step.best, options.doubt);
    std::vector<std::vector<ImageId>> places = split(step.best, cuts, options);
    SolveAttempt result = std::move(step.best.attempt);
    if (result.places->empty()) result.places = std::move(places);
    result.state.images_when_reconsidered = images;
    result.statistics.kind = kind;
    if (step.best.score != asked) {
        result.succession.reset();
        result.statistics.reset = Reset{Reset::Reason::kMissing, {}, before};
    }
    if (is_doubtful(cuts, options.doubt)) result.state.weaknesses.add(Weakness::kLookAlikes);
    return result;
}

}  // namespace psfm
