// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "graph/result.h"

namespace psfm {

/// A measured direction between two nodes, both cameras or a camera and a point, in one frame for
/// all (that of the averaged rotations): position_j - position_i = length * direction.
struct RelativeDirection {
    std::uint32_t i = 0;
    std::uint32_t j = 0;
    Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< from i to j, unit length
    double weight = 1.0;
};

/// @errors kInvalidArgument (i == j, node out of range, weight not positive, direction not of unit
/// length)
Result<void> check_directions(std::span<const RelativeDirection> edges, std::uint32_t node_count);

/// Nodes of the connected component that has most of them; of several, the one with the smallest
/// node. Ascending. REQUIRES: check_directions
std::vector<std::uint32_t> largest_component(std::span<const RelativeDirection> edges,
                                             std::uint32_t node_count);

}  // namespace psfm
