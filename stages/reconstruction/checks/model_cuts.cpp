// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/checks/model_cuts.h"

#include <functional>

#include "stages/algorithms/math/maximum_spanning_tree.h"

namespace psfm {
namespace {

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

bool can_be_compared(const Cut& cut, const DoubtOptions& options) {
    return std::min(cut.expected, cut.expected_elsewhere) >= options.min_between;
}

/// Whether what is seen from both sides is shared across.
bool is_held(const Cut& cut, const DoubtOptions& options) {
    return can_be_compared(cut, options) && cut.shared_part() >= options.held;
}

/// Two parts of a model that contradict each other, and that nothing joins better.
bool contradict_each_other(const Cut& cut, const SolveOptions& options) {
    const bool are_missed = cut.contradicting >= options.doubt.min_split_pairs &&
                            cut.missing_part() >= options.doubt.min_split_part &&
                            cut.contest() >= options.doubt.contested;
    return options.policy.makes_model(cut.images) && (are_missed || is_fold(cut, options.doubt));
}

/// How much speaks for their being two.
double contradiction(const Cut& cut) {
    return std::max(cut.missing_part(), 1.0 - cut.shared_part());
}

/// Two parts that hang together by less than what speaks for another way.
bool are_outweighed(const Cut& cut, std::size_t images, const SolveOptions& options) {
    return options.policy.makes_model(images - cut.images) && cut.explained < options.doubt.thin &&
           cut.contest() >= options.doubt.outweighed;
}

/// The cut of a kind of which there is most. Null: there is none.
template <typename IsMeant, typename Measure>
const Cut* most(const std::vector<Cut>& cuts, const IsMeant& is_meant, const Measure& measure) {
    const Cut* best = nullptr;
    for (const Cut& cut : cuts) {
        if (!is_meant(cut)) continue;
        if (best == nullptr || std::invoke(measure, cut) > std::invoke(measure, *best)) best = &cut;
    }
    return best;
}

}  // namespace

double Cut::shared_part() const {
    if (expected == 0 || shared_elsewhere == 0) return 1.0;
    return static_cast<double>(shared) / expected * expected_elsewhere / shared_elsewhere;
}

bool is_fold(const Cut& cut, const DoubtOptions& options) {
    return can_be_compared(cut, options) && cut.shared_part() < options.folded;
}

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
        for (const SeenBetween& pair : judged.between) {
            (is_across(pair) ? cut.expected : cut.expected_elsewhere) += pair.expected;
            (is_across(pair) ? cut.shared : cut.shared_elsewhere) += pair.shared;
        }
    }
    return cuts;
}

std::vector<Cut> cuts_to_try(const Judged& judged, const DoubtOptions& options) {
    std::vector<Cut> cuts = cuts_of(judged, options);
    std::erase_if(cuts, [&](const Cut& cut) {
        return cut.denied == 0.0 || (is_held(cut, options) && cut.contest() < options.min_contest);
    });
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

std::optional<Judged> in_parts(const Judged& judged, const std::vector<Cut>& cuts,
                               const SolveOptions& options) {
    if (judged.score.in_places) return std::nullopt;
    const Cut* cut = most(
        cuts, [&](const Cut& c) { return contradict_each_other(c, options); }, contradiction);
    if (cut == nullptr) return std::nullopt;
    const auto is_across = [&](const auto& pair) {
        return cut->side[pair.first] != cut->side[pair.second];
    };
    Judged apart = judged;
    apart.attempt.places = parts_of(judged.attempt.model, *cut);
    std::erase_if(apart.compared, is_across);
    std::erase_if(apart.edges, is_across);
    std::erase_if(apart.between, is_across);
    apart.score = score_of(apart, options);
    return apart;
}

std::vector<std::vector<ImageId>> outweighed_parts(const Judged& judged,
                                                   const std::vector<Cut>& cuts,
                                                   const SolveOptions& options) {
    const std::size_t images = judged.attempt.model.images.size();
    const Cut* cut = most(
        cuts, [&](const Cut& c) { return are_outweighed(c, images, options); }, &Cut::contest);
    if (cut == nullptr) return {};
    return parts_of(judged.attempt.model, *cut);
}

bool is_doubtful(const std::vector<Cut>& cuts, const DoubtOptions& options) {
    return std::ranges::any_of(cuts, [&](const Cut& cut) {
        const bool is_missed =
            cut.contradicting >= options.min_split_pairs && !is_held(cut, options);
        return is_missed || is_fold(cut, options) || cut.contest() >= options.contested;
    });
}

}  // namespace psfm
