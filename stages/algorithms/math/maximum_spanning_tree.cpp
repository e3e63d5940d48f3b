// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/math/maximum_spanning_tree.h"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <tuple>

#include "stages/algorithms/math/union_find.h"

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
    UnionFind sets(node_count);
    std::vector<std::uint32_t> forest;
    for (const std::uint32_t e : heaviest_first(edges)) {
        assert(edges[e].i < node_count && edges[e].j < node_count);
        if (sets.join(edges[e].i, edges[e].j)) forest.push_back(e);
    }
    std::ranges::sort(forest);
    return forest;
}

}  // namespace psfm
