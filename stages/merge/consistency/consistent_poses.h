// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "graph/result.h"
#include "stages/algorithms/alignment/cluster_constraint.h"
#include "stages/algorithms/alignment/cluster_pose_graph.h"
#include "stages/merge/consistency/find_contradictions.h"
#include "stages/merge/geo/place_components.h"
#include "stages/merge/values/merge_options.h"

namespace psfm {

/// Two clusters with models and edges of the view graph between them.
struct ClusterLink {
    std::uint32_t a = 0;  ///< places among the clusters of the network
    std::uint32_t b = 0;
    ClusterPairEdgesPtr edges;
    const ClusterConstraint* constraint = nullptr;  ///< what the edges say, accepted or not
};

/// Clusters with models, and all that ties them.
struct ClusterNetwork {
    std::vector<const MergeCluster*> clusters;  ///< ascending by id
    std::vector<ModelCamerasPtr> cameras;       ///< of each model
    std::vector<ClusterLink> links;             ///< ascending by clusters, each pair of them once
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

/// What the next call with the same options takes over where nothing that it follows from has
/// changed, for the same result (not persistent).
struct KnownPoses {
    std::vector<SolvedPartPtr> parts;  ///< of two clusters or more
    /// Of clusters that came to stand near each other.
    std::shared_ptr<const PairJudgements> judgements = std::make_shared<const PairJudgements>();
};

struct ConsistentPoses {
    ClusterPoses poses;  ///< `used` by link
    KnownPoses known;
    std::uint32_t parts_solved = 0;  ///< of the parts and of what they fell into: not known before
};

/// Cluster poses such that no two clusters of a component contradict each other
/// (find_contradictions.h). Ours: clusters of a connected part that do are put together again by
/// the constraints with most inliers first, as long as none contradicts another, and constraints
/// between the groups that come of it are left out; that is tried along the spanning tree, before
/// anything is optimised, since one wrong constraint of the tree is enough to see most folds, and
/// once more after it.
/// @errors kInternal (an exception from Ceres)
/// Deterministic on any number of threads. Thread-safe; parts side by side (TBB).
Result<ConsistentPoses> consistent_poses(const ClusterNetwork& network, const KnownPoses& known,
                                         const MergeOptions& options);

}  // namespace psfm
