// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/math/maximum_spanning_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include "tests/synthetic/rng.h"

namespace psfm {
namespace {

using Indices = std::vector<std::uint32_t>;

TEST(MaximumSpanningForest, TakesTheHeavyEdges) {
    const std::vector<WeightedEdge> edges{{0, 1, 1.0}, {1, 2, 5.0}, {2, 0, 3.0}, {2, 3, 0.5}};
    EXPECT_EQ(maximum_spanning_forest(edges, 4), (Indices{1, 2, 3}));
}

TEST(MaximumSpanningForest, HasATreeForEachComponent) {
    const std::vector<WeightedEdge> edges{{0, 1, 1.0}, {3, 4, 2.0}, {4, 3, 7.0}, {1, 1, 9.0}};
    EXPECT_EQ(maximum_spanning_forest(edges, 6), (Indices{0, 2}));
    EXPECT_TRUE(maximum_spanning_forest({}, 3).empty());
}

TEST(MaximumSpanningForest, BreaksTiesByNodesAndNotByListing) {
    const std::vector<WeightedEdge> edges{{0, 1, 2.0}, {0, 2, 2.0}, {1, 2, 2.0}};
    const std::vector<WeightedEdge> reversed{{2, 1, 2.0}, {2, 0, 2.0}, {1, 0, 2.0}};
    EXPECT_EQ(maximum_spanning_forest(edges, 3), (Indices{0, 1}));
    EXPECT_EQ(maximum_spanning_forest(reversed, 3), (Indices{1, 2}));
}

/// Each edge that was left out is the lightest of the cycle that it closes.
TEST(MaximumSpanningForest, IsOptimal) {
    synthetic::Rng rng(8);
    for (int round = 0; round < 100; ++round) {
        const auto nodes = static_cast<std::uint32_t>(2 + rng.below(15));
        std::vector<WeightedEdge> edges;
        for (std::uint32_t i = 0; i < nodes; ++i) {
            for (std::uint32_t j = i + 1; j < nodes; ++j) {
                if (rng.uniform() < 0.4) edges.push_back({i, j, rng.uniform()});
            }
        }
        const Indices forest = maximum_spanning_forest(edges, nodes);
        for (std::uint32_t e = 0; e < edges.size(); ++e) {
            if (std::ranges::binary_search(forest, e)) continue;
            std::vector<std::uint32_t> reached{edges[e].i};
            for (std::size_t at = 0; at < reached.size(); ++at) {
                for (const std::uint32_t f : forest) {
                    if (edges[f].weight < edges[e].weight) continue;
                    for (const auto& [a, b] :
                         {std::pair(edges[f].i, edges[f].j), std::pair(edges[f].j, edges[f].i)}) {
                        if (a != reached[at] || std::ranges::find(reached, b) != reached.end())
                            continue;
                        reached.push_back(b);
                    }
                }
            }
            EXPECT_NE(std::ranges::find(reached, edges[e].j), reached.end());
        }
    }
}

}  // namespace
}  // namespace psfm
