// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/alignment/rigid_groups.h"

#include <limits>

#include "stages/algorithms/math/maximum_spanning_tree.h"
#include "stages/algorithms/math/union_find.h"

namespace psfm {

std::vector<PoseGraphEdge> RigidGroups::edges_between(std::span<const PoseGraphEdge> edges) const {
    std::vector<PoseGraphEdge> between;
    for (PoseGraphEdge edge : edges) {
        edge.a = group_of[edge.a];
        edge.b = group_of[edge.b];
        if (edge.a != edge.b) between.push_back(edge);
    }
    return between;
}

std::vector<Sim3> RigidGroups::by_node(const std::vector<Sim3>& by_group) const {
    std::vector<Sim3> all;
    all.reserve(group_of.size());
    for (const std::uint32_t group : group_of) all.push_back(by_group[group]);
    return all;
}

RigidGroups group_rigidly(std::span<const PoseGraphEdge> edges,
                          std::span<const std::uint8_t> is_alone, std::size_t max_nodes) {
    std::vector<WeightedEdge> weighted;
    weighted.reserve(edges.size());
    for (const PoseGraphEdge& edge : edges) {
        if (is_alone[edge.a] == 0 && is_alone[edge.b] == 0)
            weighted.push_back({edge.a, edge.b, edge.weight});
    }
    UnionFind sets(is_alone.size());
    std::vector<std::size_t> size(is_alone.size(), 1);
    for (const std::uint32_t e : heaviest_first(weighted)) {
        const std::uint32_t a = sets.root_of(weighted[e].i);
        const std::uint32_t b = sets.root_of(weighted[e].j);
        if (a == b || size[a] + size[b] > max_nodes) continue;
        sets.attach(b, a);
        size[a] += size[b];
    }
    constexpr auto kUnseen = std::numeric_limits<std::uint32_t>::max();
    RigidGroups groups;
    std::vector<std::uint32_t> number(is_alone.size(), kUnseen);  // by root
    for (std::uint32_t node = 0; node < is_alone.size(); ++node) {
        const std::uint32_t root = sets.root_of(node);
        if (number[root] == kUnseen) {
            number[root] = static_cast<std::uint32_t>(groups.sizes.size());
            groups.sizes.push_back(size[root]);
        }
        groups.group_of.push_back(number[root]);
    }
    return groups;
}

}  // namespace psfm
