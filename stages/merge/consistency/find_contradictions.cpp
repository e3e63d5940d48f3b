// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/merge/consistency/find_contradictions.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

#include "stages/algorithms/math/in_parallel.h"

namespace psfm {
namespace {

/// The ball about a model's cameras in the component's frame.
struct Ball {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    double radius = 0.0;
    double reach = 0.0;  ///< how far from a camera the farthest companion may stand

    explicit Ball(const PlacedModel& placed, const ClusterConstraintOptions& options)
        : middle(placed.component_from_cluster * placed.cameras->middle),
          radius(placed.component_from_cluster.scale * placed.cameras->radius),
          reach(placed.component_from_cluster.scale * options.companion_offset *
                placed.cameras->largest_depth) {}

    bool is_near(const Ball& other) const {
        // Guard: rounding must not hide a pair that has companions.
        constexpr double kRounding = 1e-9;
        const double sum = radius + other.radius + std::min(reach, other.reach);
        return (middle - other.middle).norm() <= sum * (1.0 + kRounding);
    }
    double low() const { return middle.x() - radius - reach; }
    double high() const { return middle.x() + radius + reach; }
};

using Pair = std::pair<std::uint32_t, std::uint32_t>;

/// Pairs of models that may have companions; ascending. A sweep along x.
std::vector<Pair> near_pairs(std::span<const PlacedModel> models,
                             const ClusterConstraintOptions& options) {
    std::vector<Ball> balls;
    balls.reserve(models.size());
    for (const PlacedModel& model : models) balls.emplace_back(model, options);
    std::vector<std::uint32_t> order(models.size());
    std::iota(order.begin(), order.end(), 0U);
    std::ranges::sort(order, {}, [&](std::uint32_t m) { return std::pair(balls[m].low(), m); });
    std::vector<Pair> pairs;
    std::vector<std::uint32_t> open;
    for (const std::uint32_t next : order) {
        std::erase_if(open, [&](std::uint32_t m) { return balls[m].high() < balls[next].low(); });
        for (const std::uint32_t m : open) {
            if (balls[m].is_near(balls[next])) pairs.push_back(std::minmax(m, next));
        }
        open.push_back(next);
    }
    std::ranges::sort(pairs);
    return pairs;
}

const PairJudgement* find_known(std::span<const PairJudgement> known, const PairJudgement& wanted,
                                const ClusterConstraintOptions& options) {
    for (const PairJudgement& before :
         std::ranges::equal_range(known, clusters_of(wanted), {}, clusters_of)) {
        if (before.cameras_a == wanted.cameras_a && before.cameras_b == wanted.cameras_b &&
            before.pairs_given == wanted.pairs_given && before.pairs_hash == wanted.pairs_hash &&
            still_holds(before.verdict, *wanted.cameras_a, before.b_from_a, wanted.b_from_a,
                        options))
            return &before;
    }
    return nullptr;
}

PairJudgement judge(const PlacedModel& a, const PlacedModel& b, const ClusterPairEdges* edges,
                    std::span<const PairJudgement> known, const ClusterConstraintOptions& options) {
    PairJudgement judgement{a.id, b.id, a.cameras, b.cameras, 0, 0, {}, {}};
    std::span<const ImagePair> matched;
    if (edges != nullptr) {
        matched = edges->matched;
        judgement.pairs_given = matched.size();
        judgement.pairs_hash = edges->matched_hash;
    }
    judgement.b_from_a = inverse(b.component_from_cluster) * a.component_from_cluster;
    if (const PairJudgement* before = find_known(known, judgement, options)) return *before;
    judgement.verdict = judge_companions({a.model, a.cameras.get()}, {b.model, b.cameras.get()},
                                         judgement.b_from_a, matched, options);
    return judgement;
}

}  // namespace

Contradictions find_contradictions(std::span<const PlacedModel> models,
                                   std::span<const LinkedModels> links,
                                   std::span<const PairJudgement> known,
                                   const ClusterConstraintOptions& options) {
    Contradictions found;
    if (options.min_unmatched_cameras == 0) return found;
    const std::vector<Pair> pairs = near_pairs(models, options);
    const auto edges_of = [&](const Pair& pair) -> const ClusterPairEdges* {
        const auto link = std::ranges::lower_bound(
            links, pair, {}, [](const LinkedModels& l) { return std::pair(l.a, l.b); });
        const bool is_linked = link != links.end() && Pair(link->a, link->b) == pair;
        return is_linked ? link->edges.get() : nullptr;
    };
    found.judgements.resize(pairs.size());
    in_parallel(pairs.size(), [&](std::size_t p) {
        const auto& [a, b] = pairs[p];
        found.judgements[p] = judge(models[a], models[b], edges_of(pairs[p]), known, options);
    });
    for (std::size_t p = 0; p < pairs.size(); ++p) {
        if (found.judgements[p].verdict.contradict) found.pairs.push_back(pairs[p]);
    }
    return found;
}

}  // namespace psfm
