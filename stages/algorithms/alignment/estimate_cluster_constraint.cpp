// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/alignment/estimate_cluster_constraint.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "stages/algorithms/alignment/neighborhood_similarity.h"
#include "stages/algorithms/alignment/point_correspondences.h"
#include "stages/algorithms/alignment/refine_sim3.h"
#include "stages/algorithms/alignment/sim3_ransac.h"
#include "stages/algorithms/math/in_parallel.h"

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

/// What an edge says of the clusters: nothing if too few of its points agree.
std::optional<Sim3> similarity_of(const EdgeCorrespondences& edge,
                                  const ClusterConstraintOptions& options) {
    const auto found = estimate_sim3_ransac(std::span(&edge, 1), {}, options, edge.hash);
    if (!found || !enough_inliers(found->support, edge.points.size(), options.min_edge_inliers,
                                  options.min_inlier_ratio)) {
        return std::nullopt;
    }
    return found->b_from_a;
}

/// An edge as it was when the constraint was estimated before; null if it was not, or has changed.
const ConstraintBasis::Edge* find_edge(const ConstraintBasis* basis, std::uint64_t geometry_hash) {
    if (basis == nullptr) return nullptr;
    const auto found = std::ranges::lower_bound(basis->edges, geometry_hash, {},
                                                &ConstraintBasis::Edge::geometry_hash);
    return found != basis->edges.end() && found->geometry_hash == geometry_hash ? &*found : nullptr;
}

/// What one edge says, and whether that keeps the clusters' cameras apart.
struct EdgeOpinion {
    std::optional<Sim3> b_from_a;
    bool interleaves = false;
    bool is_new = false;  ///< not taken over
};

std::vector<EdgeOpinion> opinions_of(std::span<const EdgeCorrespondences> edges,
                                     const ClusterIndex& a, const ClusterIndex& b,
                                     const ConstraintBasis* basis,
                                     const ClusterConstraintOptions& options) {
    std::vector<EdgeOpinion> opinions(edges.size());
    in_parallel(edges.size(), [&](std::size_t e) {
        EdgeOpinion& opinion = opinions[e];
        const ConstraintBasis::Edge* known = find_edge(basis, edges[e].geometry_hash);
        opinion.is_new = known == nullptr;
        opinion.b_from_a = known != nullptr ? known->b_from_a : similarity_of(edges[e], options);
        opinion.interleaves = opinion.b_from_a && interleaves(a, b, *opinion.b_from_a, options);
    });
    return opinions;
}

void locate(ClusterConstraint& constraint, std::span<const EdgeCorrespondences> edges,
            double max_error) {
    const Sim3 a_from_b = inverse(constraint.b_from_a);
    std::vector<Eigen::Vector3d> inliers;
    for (const EdgeCorrespondences& edge : edges) {
        const CorrespondenceError error(edge, constraint.b_from_a, a_from_b);
        for (const PointCorrespondence& point : edge.points) {
            if (error(point) <= max_error) inliers.push_back(point.in_a);
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

/// The similarity that most correspondences of the accepted edges agree with.
void estimate_from_accepted(ClusterConstraint& constraint,
                            std::span<const EdgeCorrespondences> edges,
                            std::span<const Sim3> candidates,
                            const ClusterConstraintOptions& options) {
    std::uint64_t seed = 0;
    for (const EdgeCorrespondences& edge : edges) {
        constraint.correspondences += static_cast<std::uint32_t>(edge.points.size());
        seed += edge.hash;
    }
    constraint.verdict = ConstraintVerdict::kInconsistent;
    const auto found = estimate_sim3_ransac(edges, candidates, options, seed);
    if (!found.ok()) return;  // Expected: these edges agree on no similarity
    constraint.b_from_a = refine_sim3(edges, found->b_from_a, options);
    Sim3Support support = support_of(edges, constraint.b_from_a, options.max_error);
    if (support.cost > found->support.cost) {
        constraint.b_from_a = found->b_from_a;
        support = found->support;
    }
    constraint.inliers = support.inliers;
    if (!enough_inliers(support, constraint.correspondences, options.min_pair_inliers,
                        options.min_inlier_ratio)) {
        return;
    }
    locate(constraint, edges, options.max_error);
    if (constraint.extent_in_a > 0.0) constraint.verdict = ConstraintVerdict::kAccepted;
}

/// What depends on the accepted edges alone.
void take_over(ClusterConstraint& constraint, const ClusterConstraint& before) {
    constraint.verdict = before.verdict;
    constraint.b_from_a = before.b_from_a;
    constraint.correspondences = before.correspondences;
    constraint.inliers = before.inliers;
    constraint.anchor_in_a = before.anchor_in_a;
    constraint.extent_in_a = before.extent_in_a;
}

}  // namespace

ClusterConstraint estimate_cluster_constraint(const ClusterIndex& a, const ClusterIndex& b,
                                              std::span<const VerifiedPairPtr> pairs,
                                              const ClusterConstraintOptions& options,
                                              const ClusterConstraint* before) {
    ClusterConstraint constraint;
    std::vector<EdgeCorrespondences> edges = strongest_edges(a, b, pairs, options);
    constraint.edges_tried = static_cast<std::uint32_t>(edges.size());
    if (edges.empty()) return constraint;

    const ConstraintBasis* known = before != nullptr ? before->basis.get() : nullptr;
    const std::vector<EdgeOpinion> opinions = opinions_of(edges, a, b, known, options);
    auto basis = std::make_shared<ConstraintBasis>();
    std::vector<EdgeCorrespondences> accepted;
    std::vector<Sim3> candidates;
    constraint.verdict = ConstraintVerdict::kNoSimilarity;
    for (std::size_t e = 0; e < edges.size(); ++e) {
        const EdgeOpinion& opinion = opinions[e];
        basis->edges.push_back({edges[e].geometry_hash, opinion.b_from_a});
        constraint.edges_estimated += opinion.is_new ? 1 : 0;
        if (!opinion.b_from_a) continue;
        if (opinion.interleaves) {
            constraint.verdict = ConstraintVerdict::kInterleaved;
            continue;
        }
        if (candidates.size() < options.edges_as_starts) candidates.push_back(*opinion.b_from_a);
        basis->accepted.push_back(edges[e].geometry_hash);
        accepted.push_back(std::move(edges[e]));
    }
    constraint.edges_accepted = static_cast<std::uint32_t>(accepted.size());
    std::ranges::sort(basis->edges, {}, &ConstraintBasis::Edge::geometry_hash);
    if (!accepted.empty()) {
        if (known != nullptr && known->accepted == basis->accepted) {
            take_over(constraint, *before);
        } else {
            estimate_from_accepted(constraint, accepted, candidates, options);
        }
    }
    constraint.basis = std::move(basis);
    return constraint;
}

}  // namespace psfm
