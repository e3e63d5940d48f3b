// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace psfm {

/// How much speaks for two nodes' belonging together; negative: against it.
struct SignedEdge {
    std::uint32_t first = 0;
    std::uint32_t second = 0;
    double weight = 0.0;
};

/// Parts between which nothing speaks for joining them: the edge with the largest weight is
/// contracted, weights of parallel edges add up, until no weight is positive (greedy additive edge
/// contraction, Keuper et al., Efficient Decomposition of Image and Mesh Graphs by Lifted
/// Multicuts, ICCV 2015).
/// @param edges  each pair of nodes once at most, ends different and below `nodes`
/// @return by node the number of its part, consecutive from 0 in the order of their smallest nodes
/// Deterministic: ties go to the smaller nodes. Thread-safe.
std::vector<std::uint32_t> contract_signed_graph(std::size_t nodes,
                                                 std::span<const SignedEdge> edges);

}  // namespace psfm
