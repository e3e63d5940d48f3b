// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "graph/ids.h"
#include "graph/sim3.h"
#include "graph/two_view_geometry.h"

namespace psfm {

/// The view graph's edges between two clusters: pairs of an image in each.
struct ClusterPairEdges {
    ClusterId a{};  ///< a < b
    ClusterId b{};
    std::vector<VerifiedPairPtr> edges;  ///< those with a weight, ascending by images; none null
    std::uint64_t hash = 0;              ///< of which pairs they are
    std::vector<ImagePair> matched;      ///< of all, weak ones too; ascending
    std::uint64_t matched_hash = 0;      ///< of which pairs they are
};
/// Shared from version to version, as long as they stay what they are.
using ClusterPairEdgesPtr = std::shared_ptr<const ClusterPairEdges>;
/// Sorts the edges, and hashes them. REQUIRES: none is null
/// @param weak  edges without a weight (ViewGraph::Edge), in any order
ClusterPairEdgesPtr cluster_pair_edges(ClusterId a, ClusterId b, std::vector<VerifiedPairPtr> edges,
                                       std::vector<ImagePair> weak = {});

/// What became of a pair of clusters (not persistent).
enum class ConstraintVerdict : std::uint8_t {
    kAccepted,      ///< a similarity stands
    kNoEdges,       ///< no edge has enough correspondences between the models' points
    kNoSimilarity,  ///< no edge has enough inliers for any similarity
    kInterleaved,   ///< every similarity found would interleave the clusters' cameras
    kInconsistent,  ///< the edges that are left do not agree on one similarity
};
const char* describe(ConstraintVerdict verdict);

/// What a constraint was estimated from: an estimate from the same views and points is the same,
/// and need not be made again where only other parts of the clusters have changed (not persistent).
struct ConstraintBasis {
    struct Edge {
        std::uint64_t geometry_hash = 0;  ///< of its correspondences
        std::optional<Sim3> b_from_a;     ///< by RANSAC; none: too few of its points agree
    };
    std::vector<Edge> edges;              ///< those tried, ascending by hash
    std::vector<std::uint64_t> accepted;  ///< hashes of the accepted ones, strongest first
};

/// The outcome of estimating the similarity between two clusters, at given revisions of their
/// models.
struct ClusterConstraint {
    ClusterId a{};  ///< a < b
    ClusterId b{};
    std::uint32_t revision_a = 0;
    std::uint32_t revision_b = 0;
    std::uint32_t edges_given = 0;  ///< edges of the view graph between them that have a weight
    std::uint64_t edges_hash = 0;   ///< of which pairs they are
    std::uint32_t edges_tried = 0;  ///< those with enough correspondences
    std::uint32_t edges_accepted =
        0;  ///< those that passed RANSAC and the neighbourhood similarity
    std::uint32_t edges_estimated = 0;  ///< those tried for which RANSAC was run this time
    ConstraintVerdict verdict = ConstraintVerdict::kNoEdges;
    std::shared_ptr<const ConstraintBasis> basis;  ///< null without edges tried

    // Meaningful only when accepted:
    /// The pose graph rests on it; false when it contradicts the others. Set by each merge anew.
    bool used = false;
    Sim3 b_from_a;
    std::uint32_t correspondences = 0;  ///< of the accepted edges
    std::uint32_t inliers = 0;
    Eigen::Vector3d anchor_in_a = Eigen::Vector3d::Zero();  ///< mean of the inlier points
    double extent_in_a =
        1.0;  ///< root mean square distance of the inlier points from the anchor; > 0
    bool accepted() const { return verdict == ConstraintVerdict::kAccepted; }
};

}  // namespace psfm
