// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/averaging/relative_direction.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

namespace psfm {

Result<void> check_directions(std::span<const RelativeDirection> edges, std::uint32_t node_count) {
    for (std::size_t e = 0; e < edges.size(); ++e) {
        const RelativeDirection& edge = edges[e];
        const auto invalid = [&](const char* what) {
            return Error{ErrorCode::kInvalidArgument,
                         "directions: edge " + std::to_string(e) + " " + what};
        };
        if (edge.i == edge.j) return invalid("joins a node to itself");
        if (std::max(edge.i, edge.j) >= node_count) return invalid("has an unknown node");
        if (!(edge.weight > 0.0) || !std::isfinite(edge.weight)) {
            return invalid("has a weight that is not positive");
        }
        if (!(std::abs(edge.direction.norm() - 1.0) < 1e-6)) {
            return invalid("has a direction that is not of unit length");
        }
    }
    return {};
}

std::vector<std::uint32_t> largest_component(std::span<const RelativeDirection> edges,
                                             std::uint32_t node_count) {
    // Union-find in which the smallest node of a component is its root.
    std::vector<std::uint32_t> parent(node_count);
    std::iota(parent.begin(), parent.end(), 0U);
    const auto root_of = [&](std::uint32_t node) {
        while (parent[node] != node) node = parent[node] = parent[parent[node]];
        return node;
    };
    for (const RelativeDirection& edge : edges) {
        const std::uint32_t i = root_of(edge.i);
        const std::uint32_t j = root_of(edge.j);
        parent[std::max(i, j)] = std::min(i, j);
    }
    std::vector<std::uint32_t> size(node_count, 0);
    for (std::uint32_t node = 0; node < node_count; ++node) ++size[root_of(node)];
    const auto largest = static_cast<std::uint32_t>(std::ranges::max_element(size) - size.begin());
    std::vector<std::uint32_t> nodes;
    for (std::uint32_t node = 0; node < node_count; ++node) {
        if (root_of(node) == largest) nodes.push_back(node);
    }
    return nodes;
}

}  // namespace psfm
