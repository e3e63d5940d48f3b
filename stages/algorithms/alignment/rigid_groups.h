// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "stages/algorithms/alignment/cluster_pose_graph.h"

namespace psfm {

/// Nodes of a pose graph that move as one, so that there are fewer to solve for. Deterministic.
struct RigidGroups {
    std::vector<std::uint32_t> group_of;  ///< by node
    std::vector<std::size_t> sizes;       ///< by group

    /// The edges from one group to another, between groups. REQUIRES: the nodes' frames coincide,
    /// so that what an edge says of its nodes holds for their groups
    std::vector<PoseGraphEdge> edges_between(std::span<const PoseGraphEdge> edges) const;
    /// By node, of what is known by group.
    std::vector<Sim3> by_node(const std::vector<Sim3>& by_group) const;
};

/// Nodes that the strongest edges connect, up to `max_nodes` in one group.
/// @param is_alone  by node: 1 where it is to be a group of its own
RigidGroups group_rigidly(std::span<const PoseGraphEdge> edges,
                          std::span<const std::uint8_t> is_alone, std::size_t max_nodes);

}  // namespace psfm
