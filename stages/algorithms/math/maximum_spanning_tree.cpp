// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/math/maximum_spanning_tree.h"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <tuple>

namespace psfm {

std::vector<std::uint32_t> heaviest_first(std::span<const WeightedEdge> edges) {
    std::vector<std::uint32_t> order(edges.size());
    std::iota(order.begin(), order.end(), 0U);
    std::ranges::sort(order, {}, [&](std::uint32_t e) {
        const auto [low, high] = std::minmax(edges[e].i, edges[e].j);
        return std::tuple(-edges[e].weight, low, high, e);
    });
    return order;
}

std::vector<std::uint32_t> maximum_spanning_forest(std::span<const WeightedEdge> edges,
                                                   std::uint32_t node_count) {
    std::vector<std::uint32_t> parent(node_count);
    std::iota(parent.begin(), parent.end(), 0U);
    const auto root_of = [&](std::uint32_t node) {
        while (parent[node] != node) node = parent[node] = parent[parent[node]];
        return node;
    };
    std::vector<std::uint32_t> forest;
    for (const std::uint32_t e : heaviest_first(edges)) {
        assert(edges[e].i < node_count && edges[e].j < node_count);
        const std::uint32_t a = root_of(edges[e].i);
        const std::uint32_t b = root_of(edges[e].j);
        if (a == b) continue;
        parent[std::max(a, b)] = std::min(a, b);
        forest.push_back(e);
    }
    std::ranges::sort(forest);
    return forest;
}

}  // namespace psfm
