// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/checks/open_edges.h"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <utility>

#include "stages/algorithms/alignment/refine_sim3.h"
#include "stages/algorithms/alignment/sim3_ransac.h"
#include "stages/algorithms/math/in_parallel.h"
#include "stages/algorithms/math/median.h"

namespace psfm {
namespace {

constexpr std::size_t kEdgesATask = 64;  // Guard: of tasks too small to pay

EdgeView view_of(const WorkingModel& model, std::uint32_t image) {
    const Camera& camera = model.camera(image);
    return {model.pose(image), camera.fx() / std::max(camera.width, camera.height)};
}

/// An edge between registered images, and the points that its matches belong to.
struct Ends {
    std::uint32_t first = 0;  ///< local numbers
    std::uint32_t second = 0;
    /// Of each match with points at both ends, that of the first image's feature and that of the
    /// second's.
    std::vector<std::pair<std::uint32_t, std::uint32_t>> points;
    std::size_t shared = 0;  ///< matches of which they are one
};

/// Nothing when too few matches have points.
std::optional<Ends> ends_of(const WorkingModel& model, const VerifiedPair& pair,
                            const LoopOptions& options) {
    Ends ends{model.numbers().of(pair.pair.first), model.numbers().of(pair.pair.second), {}, 0};
    if (!model.registered(ends.first) || !model.registered(ends.second)) return std::nullopt;
    for (const FeatureMatch& match : pair.geometry.inliers) {
        const std::uint32_t p = model.point_of({ends.first, match.first});
        const std::uint32_t q = model.point_of({ends.second, match.second});
        if (p == WorkingModel::kNoPoint || q == WorkingModel::kNoPoint) continue;
        if (p == q) ++ends.shared;
        ends.points.emplace_back(p, q);
    }
    if (ends.points.size() < options.min_matches) return std::nullopt;
    return ends;
}

bool holds(const Ends& ends, const LoopOptions& options) {
    return static_cast<double>(ends.shared) >
           options.max_shared_part * static_cast<double>(ends.points.size());
}

/// Where the first image's points stand, and the second's.
EdgeCorrespondences points_of(const WorkingModel& model, const VerifiedPair& pair,
                              const Ends& ends) {
    EdgeCorrespondences found;
    found.pair = pair.pair;
    found.view_a = view_of(model, ends.first);
    found.view_b = view_of(model, ends.second);
    for (const auto& [p, q] : ends.points)
        found.points.push_back({model.points()[p].position, model.points()[q].position});
    return found;
}

/// An edge that asks for staying as one is, without its weight.
PoseGraphEdge edge_at(const WorkingModel& model, const Ends& ends) {
    Eigen::Vector3d anchor = Eigen::Vector3d::Zero();
    std::vector<double> depths;
    depths.reserve(ends.points.size());
    for (const auto& [p, q] : ends.points) {
        const Eigen::Vector3d& position = model.points()[p].position;
        anchor += position;
        depths.push_back((position - model.centre(ends.first)).norm());
    }
    const auto count = static_cast<double>(ends.points.size());
    return {ends.first, ends.second, Sim3{}, anchor / count, upper_median(std::move(depths)), 1.0};
}

/// How far the two points of a match are apart over their depth, in the median.
double gap_of(const WorkingModel& model, const EdgeCorrespondences& found, const Ends& ends) {
    std::vector<double> gaps;
    gaps.reserve(found.points.size());
    for (const PointCorrespondence& point : found.points) {
        gaps.push_back((point.in_b - point.in_a).norm() /
                       (point.in_a - model.centre(ends.first)).norm());
    }
    return upper_median(std::move(gaps));
}

/// The similarity that takes the first image's points to the second's; nothing where they agree on
/// none.
std::optional<Sim3> relation_of(const EdgeCorrespondences& found) {
    const ClusterConstraintOptions options;
    const std::uint64_t seed = (std::uint64_t{index_of(found.pair.first)} << 32U) |
                               std::uint64_t{index_of(found.pair.second)};
    const auto robust = estimate_sim3_ransac(std::span(&found, 1), {}, options, seed);
    // Expected: points that agree on no similarity have no relation
    if (!robust.ok() || robust->support.inliers < options.min_edge_inliers) return std::nullopt;
    return refine_sim3(std::span(&found, 1), robust->b_from_a, options);
}

std::optional<PoseGraphEdge> open_edge(const WorkingModel& model, const VerifiedPair& pair,
                                       const LoopOptions& options) {
    const auto ends = ends_of(model, pair, options);
    if (!ends || holds(*ends, options)) return std::nullopt;
    const EdgeCorrespondences found = points_of(model, pair, *ends);
    if (gap_of(model, found, *ends) < options.min_gap) return std::nullopt;
    const std::optional<Sim3> relation = relation_of(found);
    if (!relation) return std::nullopt;
    PoseGraphEdge edge = edge_at(model, *ends);
    edge.b_from_a = *relation;
    edge.weight = static_cast<double>(ends->points.size());
    return edge;
}

/// Common points of an edge that holds, by edge.
struct Strength {
    std::uint32_t first = 0;  ///< local numbers
    std::uint32_t second = 0;
    std::size_t shared = 0;  ///< 0: it does not hold
};

/// Edges that are among the strongest of either image, ascending.
std::vector<std::size_t> strongest_of_each(const std::vector<Strength>& edges, std::size_t images,
                                           std::size_t per_image) {
    std::vector<std::vector<std::pair<std::size_t, std::size_t>>> at(images);
    for (std::size_t e = 0; e < edges.size(); ++e) {
        if (edges[e].shared == 0) continue;
        for (const std::uint32_t image : {edges[e].first, edges[e].second})
            at[image].emplace_back(edges[e].shared, e);
    }
    std::vector<std::uint8_t> is_kept(edges.size(), 0);
    for (auto& own : at) {
        const auto kept =
            own.begin() + static_cast<std::ptrdiff_t>(std::min(per_image, own.size()));
        std::ranges::partial_sort(own, kept, std::ranges::greater());
        for (auto edge = own.begin(); edge != kept; ++edge) is_kept[edge->second] = 1;
    }
    std::vector<std::size_t> strongest;
    for (std::size_t e = 0; e < edges.size(); ++e) {
        if (is_kept[e] != 0) strongest.push_back(e);
    }
    return strongest;
}

}  // namespace

std::vector<PoseGraphEdge> find_open_edges(const WorkingModel& model, const LocalGraph& graph,
                                           const LoopOptions& options) {
    std::vector<std::optional<PoseGraphEdge>> found(graph.pairs.size());
    in_parallel(graph.pairs.size(), kEdgesATask,
                [&](std::size_t e) { found[e] = open_edge(model, *graph.pairs[e], options); });
    std::vector<PoseGraphEdge> open;
    for (const auto& edge : found) {
        if (edge) open.push_back(*edge);
    }
    return open;
}

std::vector<PoseGraphEdge> find_holding_edges(const WorkingModel& model, const LocalGraph& graph,
                                              const LoopOptions& options) {
    std::vector<Strength> strengths(graph.pairs.size());
    in_parallel(graph.pairs.size(), kEdgesATask, [&](std::size_t e) {
        const auto ends = ends_of(model, *graph.pairs[e], options);
        if (ends && holds(*ends, options)) strengths[e] = {ends->first, ends->second, ends->shared};
    });
    const std::vector<std::size_t> strongest =
        strongest_of_each(strengths, model.image_count(), options.edges_per_image);
    std::vector<PoseGraphEdge> holding(strongest.size());
    in_parallel(strongest.size(), kEdgesATask, [&](std::size_t k) {
        holding[k] = edge_at(model, *ends_of(model, *graph.pairs[strongest[k]], options));
        holding[k].weight = static_cast<double>(strengths[strongest[k]].shared);
    });
    return holding;
}

}  // namespace psfm
