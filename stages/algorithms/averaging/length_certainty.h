// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "graph/result.h"
#include "stages/algorithms/averaging/average_positions.h"
#include "stages/algorithms/averaging/position_system.h"

namespace psfm {

/// Standard deviation [rad] of a direction across itself, from the median of the edges' chords.
double direction_noise(const std::vector<RelativeDirection>& edges, const Columns3& positions);

/// The largest set of nodes whose distances the directions determine relative to one another.
/// Draws from the normal distribution of the positions, given directions with noise and next to no
/// prior knowledge, show by how much each edge's length may change; edges that meet in a node
/// belong together when their lengths change by the same part. What flexes in the graph (parts
/// that meet in one node only) or at these positions (nodes on a line) changes by different parts.
/// Distances that drift slowly over a large graph do not count against it.
/// @return nodes, ascending; empty when no two lengths belong together
/// @errors kInternal (the normal matrix cannot be factored)
/// Deterministic.
Result<std::vector<std::uint32_t>> nodes_of_certain_length(
    const std::vector<RelativeDirection>& edges, const Columns3& positions,
    const PositionAveragingOptions& options);

}  // namespace psfm
