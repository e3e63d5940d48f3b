// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "graph/result.h"
#include "stages/merge/cluster_constraint.h"
#include "stages/merge/cluster_pose_graph.h"
#include "stages/merge/merge_options.h"
#include "stages/merge/place_components.h"

namespace psfm {

/// Two clusters with models and edges of the view graph between them.
struct ClusterLink {
    std::uint32_t a = 0;  ///< places among the clusters of the network
    std::uint32_t b = 0;
    const ClusterPairEdges* edges = nullptr;
    const ClusterConstraint* constraint = nullptr;  ///< what the edges say, accepted or not
};

/// Clusters with models, and all that ties them.
struct ClusterNetwork {
    std::vector<const MergeCluster*> clusters;                       ///< ascending by id
    std::vector<std::shared_ptr<const std::vector<double>>> depths;  ///< mean_depths() of each
    std::vector<ClusterLink> links;  ///< ascending by clusters, each pair of them once
};

struct SolvedPart;
using SolvedPartPtr = std::shared_ptr<const SolvedPart>;

/// What became of clusters that constraints connect, directly or through others (not persistent).
struct SolvedPart {
    /// All that the poses follow from: clusters, their revisions, and the edges between them.
    std::vector<std::uint64_t> basis;
    ClusterPoses poses;                 ///< of its clusters, ascending; `used` by link between them
    std::vector<SolvedPartPtr> groups;  ///< that it fell into; none if nothing contradicts
};

struct ConsistentPoses {
    ClusterPoses poses;                ///< `used` by link
    std::vector<SolvedPartPtr> parts;  ///< of two clusters or more
    std::uint32_t parts_solved = 0;    ///< of these and of what they fell into: not known before
};

/// Cluster poses such that no two clusters of a component contradict each other
/// (find_contradictions.h). Ours: clusters of a connected part that do are put together again by
/// the constraints with most inliers first, as long as none contradicts another, and constraints
/// between the groups that come of it are left out; that is tried along the spanning tree, before
/// anything is optimised, since one wrong constraint of the tree is enough to see most folds, and
/// once more after it.
/// @param known  of an earlier call with the same options, for the same result: a part that is what
///               it was is not looked at again
/// @errors kInternal (an exception from Ceres)
/// Deterministic on any number of threads. Thread-safe; parts side by side (TBB).
Result<ConsistentPoses> consistent_poses(const ClusterNetwork& network,
                                         std::span<const SolvedPartPtr> known,
                                         const MergeOptions& options);

}  // namespace psfm
