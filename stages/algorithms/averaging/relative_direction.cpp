// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/averaging/relative_direction.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "stages/algorithms/math/union_find.h"

namespace psfm {

Result<void> check_directions(std::span<const RelativeDirection> edges, std::uint32_t node_count) {
    constexpr double kUnitTolerance = 1e-6;  // Guard: of what callers normalise; rounding is less
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
        if (!(std::abs(edge.direction.norm() - 1.0) < kUnitTolerance)) {
            return invalid("has a direction that is not of unit length");
        }
    }
    return {};
}

std::vector<std::uint32_t> largest_component(std::span<const RelativeDirection> edges,
                                             std::uint32_t node_count) {
    UnionFind sets(node_count);  // the smallest node of a component is its root
    for (const RelativeDirection& edge : edges) sets.join(edge.i, edge.j);
    std::vector<std::uint32_t> size(node_count, 0);
    for (std::uint32_t node = 0; node < node_count; ++node) ++size[sets.root_of(node)];
    const auto largest = static_cast<std::uint32_t>(std::ranges::max_element(size) - size.begin());
    std::vector<std::uint32_t> nodes;
    for (std::uint32_t node = 0; node < node_count; ++node) {
        if (sets.root_of(node) == largest) nodes.push_back(node);
    }
    return nodes;
}

}  // namespace psfm
