// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/merge/estimate_cluster_constraint.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "stages/merge/neighborhood_similarity.h"
#include "stages/merge/point_correspondences.h"
#include "stages/merge/refine_sim3.h"
#include "stages/merge/sim3_ransac.h"

namespace psfm {
namespace {

std::vector<EdgeCorrespondences> strongest_edges(const ClusterIndex& a, const ClusterIndex& b,
                                                 std::span<const VerifiedPairPtr> pairs,
                                                 const ClusterConstraintOptions& options) {
    std::vector<EdgeCorrespondences> edges;
    for (const VerifiedPairPtr& pair : pairs) {
        EdgeCorrespondences edge = collect_correspondences(*pair, a, b);
        if (edge.points.size() >= options.min_edge_inliers) edges.push_back(std::move(edge));
    }
    std::ranges::sort(edges, [](const EdgeCorrespondences& x, const EdgeCorrespondences& y) {
        return std::tuple(y.points.size(), x.pair) < std::tuple(x.points.size(), y.pair);
    });
    const std::size_t limit = options.max_edges_per_pair;
    if (limit > 0 && edges.size() > limit) edges.resize(limit);
    return edges;
}

/// Similarities of single edges that the final one may start from, those of the strongest edges.
constexpr std::size_t kCandidates = 10;

bool interleaves(const ClusterIndex& a, const ClusterIndex& b, const Sim3& b_from_a,
                 const ClusterConstraintOptions& options) {
    const NeighborhoodCount count = count_kept_neighbors(a, b, b_from_a);
    return count.similarity() < options.min_neighborhood_similarity &&
           count.all - count.kept > options.border_cameras;
}

bool enough_inliers(const Sim3Support& support, std::size_t correspondences, std::uint32_t least,
                    double ratio) {
    return support.inliers >= least &&
           static_cast<double>(support.inliers) >= ratio * static_cast<double>(correspondences);
}

/// What one edge says of the clusters.
struct EdgeOpinion {
    std::optional<Sim3> b_from_a;  ///< none: too few of its points agree
    bool interleaves = false;
};

EdgeOpinion opinion_of(const EdgeCorrespondences& edge, const ClusterIndex& a,
                       const ClusterIndex& b, const ClusterConstraintOptions& options) {
    const auto found = estimate_sim3_ransac(std::span(&edge, 1), {}, options, edge.hash);
    if (!found || !enough_inliers(found->support, edge.points.size(), options.min_edge_inliers,
                                  options.min_inlier_ratio)) {
        return {};
    }
    return {found->b_from_a, interleaves(a, b, found->b_from_a, options)};
}

void locate(ClusterConstraint& constraint, std::span<const EdgeCorrespondences> edges,
            double max_error) {
    const Sim3 a_from_b = inverse(constraint.b_from_a);
    std::vector<Eigen::Vector3d> inliers;
    for (const EdgeCorrespondences& edge : edges) {
        for (const PointCorrespondence& point : edge.points) {
            if (correspondence_error(edge, point, constraint.b_from_a, a_from_b) <= max_error) {
                inliers.push_back(point.in_a);
            }
        }
    }
    for (const Eigen::Vector3d& point : inliers) constraint.anchor_in_a += point;
    constraint.anchor_in_a /= static_cast<double>(inliers.size());
    double squares = 0.0;
    for (const Eigen::Vector3d& point : inliers) {
        squares += (point - constraint.anchor_in_a).squaredNorm();
    }
    constraint.extent_in_a = std::sqrt(squares / static_cast<double>(inliers.size()));
}

}  // namespace

ClusterConstraint estimate_cluster_constraint(const ClusterIndex& a, const ClusterIndex& b,
                                              std::span<const VerifiedPairPtr> pairs,
                                              const ClusterConstraintOptions& options) {
    ClusterConstraint constraint;
    std::vector<EdgeCorrespondences> edges = strongest_edges(a, b, pairs, options);
    constraint.edges_tried = static_cast<std::uint32_t>(edges.size());
    if (edges.empty()) return constraint;

    std::vector<EdgeOpinion> opinions(edges.size());
    // Isolated: a version is not to wait for a solve that this thread takes up in between.
    tbb::this_task_arena::isolate([&] {
        tbb::parallel_for(std::size_t{0}, edges.size(), [&](std::size_t e) {
            opinions[e] = opinion_of(edges[e], a, b, options);
        });
    });
    std::vector<EdgeCorrespondences> surviving;
    std::vector<Sim3> candidates;
    std::uint64_t seed = 0;
    constraint.verdict = ConstraintVerdict::kNoSimilarity;
    for (std::size_t e = 0; e < edges.size(); ++e) {
        if (!opinions[e].b_from_a) continue;
        if (opinions[e].interleaves) {
            constraint.verdict = ConstraintVerdict::kInterleaved;
            continue;
        }
        if (candidates.size() < kCandidates) candidates.push_back(*opinions[e].b_from_a);
        seed += edges[e].hash;
        surviving.push_back(std::move(edges[e]));
    }
    if (surviving.empty()) return constraint;

    constraint.edges_accepted = static_cast<std::uint32_t>(surviving.size());
    for (const EdgeCorrespondences& edge : surviving) {
        constraint.correspondences += static_cast<std::uint32_t>(edge.points.size());
    }
    constraint.verdict = ConstraintVerdict::kInconsistent;
    const auto found = estimate_sim3_ransac(surviving, candidates, options, seed);
    if (!found) return constraint;
    constraint.b_from_a = refine_sim3(surviving, found->b_from_a, options.max_error);
    Sim3Support support = support_of(surviving, constraint.b_from_a, options.max_error);
    if (support.cost > found->support.cost) {
        constraint.b_from_a = found->b_from_a;
        support = found->support;
    }
    constraint.inliers = support.inliers;
    if (!enough_inliers(support, constraint.correspondences, options.min_pair_inliers,
                        options.min_inlier_ratio)) {
        return constraint;
    }
    locate(constraint, surviving, options.max_error);
    if (constraint.extent_in_a > 0.0) constraint.verdict = ConstraintVerdict::kAccepted;
    return constraint;
}

}  // namespace psfm
