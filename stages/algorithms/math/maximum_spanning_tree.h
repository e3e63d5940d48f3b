// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace psfm {

/// Undirected edge between two nodes 0 … node_count-1.
struct WeightedEdge {
    std::uint32_t i = 0;
    std::uint32_t j = 0;
    double weight = 0.0;
};

/// Indices of the edges, of greatest weight first; equal weights in ascending order of the edge's
/// nodes, then of its index: the order in which distinct edges are listed makes no difference.
/// Thread-safe.
std::vector<std::uint32_t> heaviest_first(std::span<const WeightedEdge> edges);

/// Maximum spanning forest by Kruskal's method, edges in the order of heaviest_first(): one tree
/// for every connected component. REQUIRES: i, j < node_count. Loops (i == j) are never in the
/// forest.
/// @return indices into edges, ascending. Thread-safe.
std::vector<std::uint32_t> maximum_spanning_forest(std::span<const WeightedEdge> edges,
                                                   std::uint32_t node_count);

}  // namespace psfm
