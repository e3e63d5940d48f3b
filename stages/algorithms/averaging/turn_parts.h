// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "stages/algorithms/averaging/average_rotations.h"

namespace psfm {

/// Asks once more how parts stand to all that is around them. Parts are joined strongest edge
/// first, when most edges that would have a say still lead to parts that come later; here all of
/// them vote. A part is turned where turn_again_factor times more weight agrees with another
/// rotation than with the one that it has, the strongest edge of each left out: one edge by itself
/// holds no part, and turns none. Nor do edges that together, with the strongest, weigh less than
/// half of those that hold it. Ours (docs/look-alikes.md, "Rotations").
/// @param parts  nodes of each, in the order in which they are asked
/// @param rank   by edge: 0 for the strongest
/// @param node_from_reference  is read and written
void turn_parts(std::span<const RelativeRotation> edges, std::span<const std::uint32_t> rank,
                const std::vector<std::vector<std::uint32_t>>& parts,
                const RotationAveragingOptions& options,
                std::vector<Eigen::Quaterniond>& node_from_reference);

}  // namespace psfm
