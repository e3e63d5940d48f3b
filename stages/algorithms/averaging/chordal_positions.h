// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "graph/result.h"
#include "stages/algorithms/averaging/average_positions.h"
#include "stages/algorithms/averaging/position_system.h"

namespace psfm {

/// Chord between an edge's measured direction and that of the positions, in [0, 2]: 2 sin of half
/// the angle. 1 where the ends coincide.
double chord(const RelativeDirection& edge, const Columns3& positions);

/// Minimises the weighted sum of Huber losses of the chords, from the given positions (Wilson &
/// Snavely 2014, sec. 4). Gauge: node 0 stays, and one coordinate of the node farthest from it.
/// REQUIRES: edges valid and connected.
/// @errors kDegenerate (Ceres found no usable solution)
Result<Columns3> refine_positions(const std::vector<RelativeDirection>& edges, Columns3 positions,
                                  const PositionAveragingOptions& options);

}  // namespace psfm
