// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "graph/result.h"
#include "stages/algorithms/averaging/average_positions.h"
#include "stages/algorithms/averaging/position_system.h"

namespace psfm {

/// Minimises the weighted sum of |x_j - x_i - length_e * direction_e| over positions and lengths >=
/// 1 (Ozyesil & Singer 2015): convex, and robust since deviations are not squared. The bound keeps
/// the positions from collapsing.
///
/// Solved by iteratively reweighted least squares. What the publication solves as a quadratic
/// program in each iteration is taken as the squared distance of x_j - x_i from the ray of allowed
/// differences, once differentiable: one Newton step, halved until the sum is lower.
///
/// REQUIRES: edges valid and connected, 2 nodes at least.
/// @return node 0 at the origin
/// @errors kInternal (the normal matrix cannot be factored)
Result<Columns3> least_unsquared_positions(const std::vector<RelativeDirection>& edges,
                                           std::uint32_t node_count,
                                           const PositionAveragingOptions& options);

}  // namespace psfm
