// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "graph/result.h"
#include "graph/sim3.h"
#include "stages/algorithms/alignment/alignment_options.h"
#include "stages/algorithms/alignment/cluster_constraint.h"

namespace psfm {

/// A constraint of the pose graph between clusters 0 … cluster_count-1.
struct PoseGraphEdge {
    std::uint32_t a = 0;
    std::uint32_t b = 0;
    Sim3 b_from_a;
    Eigen::Vector3d anchor_in_a = Eigen::Vector3d::Zero();  ///< where shifts are measured
    double extent_in_a = 1.0;                               ///< unit of shifts; > 0
    double weight = 1.0;                                    ///< inliers; counts as its square root
};

struct ClusterPoses {
    /// By cluster: pose in its component's frame, which is that of the component's root.
    std::vector<Sim3> component_from_cluster;
    std::vector<std::uint32_t> component;  ///< by cluster; 0, 1, … ascending by smallest cluster
    std::uint32_t component_count = 0;
    std::vector<bool> used;  ///< by edge; false: dropped, as the others contradict it
};

/// Residual of an edge: rotation [rad], log scale, and shift of the anchor in extents, together
/// seven numbers; their Euclidean norm.
double pose_graph_residual(const PoseGraphEdge& edge, const Sim3& frame_from_a,
                           const Sim3& frame_from_b);

/// Cluster poses from relative similarities (paper sec. "Cluster Pose Estimation": sum of
/// Huber-robust squared residuals), started from the maximum spanning tree by weight. Differs from
/// the paper: constraints count by the square root of their inliers, and one whose residual stays
/// above max_residual is dropped, the worst first, as long as its component stays connected.
/// @param sizes by cluster: placed images; the largest cluster of a component is its root (ties:
/// first)
/// @errors kInternal (an exception from Ceres)
/// Deterministic. Thread-safe.
Result<ClusterPoses> solve_cluster_poses(std::span<const PoseGraphEdge> edges,
                                         std::span<const std::size_t> sizes,
                                         const PoseGraphOptions& options);

/// The same from poses that are known roughly, all in one frame; no constraint is dropped, and the
/// first of the largest clusters of each component stays where it is.
/// @errors kInternal (an exception from Ceres)
Result<std::vector<Sim3>> refine_cluster_poses(std::span<const PoseGraphEdge> edges,
                                               std::span<const std::size_t> sizes,
                                               std::span<const Sim3> frame_from_cluster,
                                               const PoseGraphOptions& options);

/// The same as solve_cluster_poses, before anything is optimised: poses along the maximum spanning
/// tree by weight.
ClusterPoses poses_along_tree(std::span<const PoseGraphEdge> edges,
                              std::span<const std::size_t> sizes);

}  // namespace psfm
