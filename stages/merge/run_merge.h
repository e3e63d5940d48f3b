// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "graph/ids.h"
#include "graph/image.h"
#include "graph/result.h"
#include "graph/scene.h"
#include "graph/sim3.h"
#include "graph/two_view_geometry.h"
#include "stages/algorithms/alignment/cluster_constraint.h"
#include "stages/merge/consistency/consistent_poses.h"
#include "stages/merge/geo/place_components.h"
#include "stages/merge/values/image_evidence.h"
#include "stages/merge/values/merge_options.h"

namespace psfm {

struct MergeProblem {
    std::vector<MergeCluster> clusters;      ///< ascending by id
    std::vector<ClusterPairEdgesPtr> pairs;  ///< ascending by (a, b), each at most once
    /// MergeResult::constraints and MergeResult::set_aside of the version before, in any order.
    std::vector<ClusterConstraint> known;
    KnownPoses known_poses;            ///< MergeResult::known_poses of the version before
    ScenePtr previous;                 ///< the published version before; null for the first
    std::vector<WorldAnchor> anchors;  ///< ascending by image; of a session that began with a model
    std::vector<ImageEvidence> evidence;  ///< of the session, ascending by image; may be empty
};

/// Where one cluster stands.
struct ClusterPlacement {
    ClusterId id{};
    Sim3 world_from_cluster;
    std::uint32_t effective_cluster = 0;  ///< see MergeResult
};

struct MergeResult {
    std::vector<ClusterPlacement>
        placements;  ///< one for each cluster of the problem, ascending by id
    /// Number of effective clusters that hold a model. They are numbered from 0 by placed images,
    /// most first, ties by smallest cluster id; clusters without a model follow, each one by
    /// itself.
    std::uint32_t effective_clusters = 0;
    std::vector<ClusterConstraint>
        constraints;  ///< ascending by (a, b): one for each pair with two models
    /// Known ones of pairs without two models, to start from when they have them again.
    std::vector<ClusterConstraint> set_aside;
    /// What each effective cluster that holds a model stands on, by its number.
    std::vector<ComponentPlace> places;
    std::optional<GpsPosition> datum;  ///< see PlacedComponents
    /// Of each model, ascending by cluster.
    std::vector<std::pair<ClusterId, ModelCamerasPtr>> cameras;
    KnownPoses known_poses;
    std::uint32_t reused = 0;        ///< constraints taken from MergeProblem::known
    std::uint32_t parts_solved = 0;  ///< see ConsistentPoses
    std::uint32_t dropped = 0;       ///< accepted constraints that the pose graph contradicts
};

/// Clusters whose points run_merge() looks at: those with a constraint that is not known. The
/// others may come without, as long as their cameras are known. Ascending.
std::vector<ClusterId> clusters_to_look_into(const MergeProblem& problem);

/// Puts the clusters' models into one frame (paper sec. "Cluster Pose Estimation"):
/// a Sim(3) by RANSAC for every edge between two clusters, its neighbourhood similarity, a final
/// Sim(3) for each pair from the surviving edges, a pose graph with Huber loss over all clusters.
/// Each connected component of accepted constraints is one effective cluster.
///
/// The frame does not jump, and is that of the earth once the photographs' positions tell it:
/// place_components.h has the rules. Positions and gravity place whole components and join none.
/// A known constraint is used again when both revisions and the edges are what they were, and the
/// poses of clusters that constraints connect when that is so of all of them: what a version costs
/// follows from what has changed, but for laying it out in one frame.
///
/// @errors kInvalidArgument (lists not ascending, unknown clusters, options)
/// Deterministic: bitwise equal for equal inputs. Thread-safe.
Result<MergeResult> run_merge(const MergeProblem& problem, const MergeOptions& options);

}  // namespace psfm
