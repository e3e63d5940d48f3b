// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/open_edges.h"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <utility>

#include "stages/merge/refine_sim3.h"
#include "stages/merge/sim3_ransac.h"
#include "stages/reconstruction/in_parallel.h"

namespace psfm {
namespace {

constexpr std::size_t kEdgesATask = 64;

/// What the model's points say of an edge.
struct Verdict {
    enum class Kind : std::uint8_t { kNothing, kHolds, kOpen } kind = Kind::kNothing;
    PoseGraphEdge edge;
};

double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::ranges::nth_element(values, middle);
    return *middle;
}

EdgeView view_of(const WorkingModel& model, std::uint32_t image) {
    const Camera& camera = model.camera(image);
    return {model.pose(image), camera.fx() / std::max(camera.width, camera.height)};
}

/// The matches with points at both ends: where the first image's stands, and the second's.
EdgeCorrespondences points_of(const WorkingModel& model, const VerifiedPair& pair,
                              std::uint32_t first, std::uint32_t second, std::size_t& shared) {
    EdgeCorrespondences found;
    found.pair = pair.pair;
    found.view_a = view_of(model, first);
    found.view_b = view_of(model, second);
    for (const FeatureMatch& match : pair.geometry.inliers) {
        const std::uint32_t p = model.point_of({first, match.first});
        const std::uint32_t q = model.point_of({second, match.second});
        if (p == WorkingModel::kNoPoint || q == WorkingModel::kNoPoint) continue;
        if (p == q) ++shared;
        found.points.push_back({model.points()[p].position, model.points()[q].position});
    }
    return found;
}

/// The similarity that takes the first image's points to the second's; nothing where they agree on
/// none.
std::optional<Sim3> relation_of(const EdgeCorrespondences& found) {
    const ClusterConstraintOptions options;
    const std::uint64_t seed = (std::uint64_t{index_of(found.pair.first)} << 32U) |
                               std::uint64_t{index_of(found.pair.second)};
    const auto robust = estimate_sim3_ransac(std::span(&found, 1), {}, options, seed);
    if (!robust.ok() || robust->support.inliers < options.min_edge_inliers) return std::nullopt;
    return refine_sim3(std::span(&found, 1), robust->b_from_a, options.max_error);
}

Verdict judge(const WorkingModel& model, const VerifiedPair& pair, const LoopOptions& options) {
    Verdict verdict;
    const std::uint32_t first = model.numbers().of(pair.pair.first);
    const std::uint32_t second = model.numbers().of(pair.pair.second);
    if (!model.registered(first) || !model.registered(second)) return verdict;
    std::size_t shared = 0;
    const EdgeCorrespondences found = points_of(model, pair, first, second, shared);
    if (found.points.size() < options.min_matches) return verdict;

    Eigen::Vector3d anchor = Eigen::Vector3d::Zero();
    std::vector<double> gaps;
    std::vector<double> depths;
    for (const PointCorrespondence& point : found.points) {
        anchor += point.in_a;
        depths.push_back((point.in_a - model.centre(first)).norm());
        gaps.push_back((point.in_b - point.in_a).norm() / depths.back());
    }
    const auto count = static_cast<double>(found.points.size());
    verdict.edge = {first, second, Sim3{}, anchor / count, median(depths), 1.0};
    if (static_cast<double>(shared) > options.max_shared_part * count) {
        verdict.kind = Verdict::Kind::kHolds;
        verdict.edge.weight = static_cast<double>(shared);
        return verdict;
    }
    if (median(gaps) < options.min_gap) return verdict;
    const std::optional<Sim3> relation = relation_of(found);
    if (!relation) return verdict;
    verdict.kind = Verdict::Kind::kOpen;
    verdict.edge.b_from_a = *relation;
    verdict.edge.weight = count;
    return verdict;
}

/// Of the edges that hold, those that are among the strongest of either image.
std::vector<PoseGraphEdge> strongest_of_each(std::vector<PoseGraphEdge> edges, std::size_t images,
                                             std::size_t per_image) {
    std::vector<std::vector<std::pair<double, std::size_t>>> at(images);
    for (std::size_t e = 0; e < edges.size(); ++e) {
        for (const std::uint32_t image : {edges[e].a, edges[e].b})
            at[image].emplace_back(edges[e].weight, e);
    }
    std::vector<std::uint8_t> is_kept(edges.size(), 0);
    for (auto& own : at) {
        const auto kept =
            own.begin() + static_cast<std::ptrdiff_t>(std::min(per_image, own.size()));
        std::ranges::partial_sort(own, kept, std::ranges::greater());
        for (auto edge = own.begin(); edge != kept; ++edge) is_kept[edge->second] = 1;
    }
    std::vector<PoseGraphEdge> strongest;
    for (std::size_t e = 0; e < edges.size(); ++e) {
        if (is_kept[e] != 0) strongest.push_back(edges[e]);
    }
    return strongest;
}

}  // namespace

JudgedEdges judge_edges(const WorkingModel& model, const LocalGraph& graph,
                        const LoopOptions& options) {
    std::vector<Verdict> verdicts(graph.pairs.size());
    in_parallel(graph.pairs.size(), kEdgesATask,
                [&](std::size_t e) { verdicts[e] = judge(model, *graph.pairs[e], options); });
    JudgedEdges judged;
    for (const Verdict& verdict : verdicts) {
        if (verdict.kind == Verdict::Kind::kHolds) judged.holding.push_back(verdict.edge);
        if (verdict.kind == Verdict::Kind::kOpen) judged.open.push_back(verdict.edge);
    }
    judged.holding =
        strongest_of_each(std::move(judged.holding), model.image_count(), options.edges_per_image);
    return judged;
}

}  // namespace psfm
