// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "stages/algorithms/averaging/average_rotations.h"

namespace psfm {

/// Rotations that averaging starts from, and the connected components, as in RotationAveraging.
struct StartRotations {
    std::vector<Eigen::Quaterniond> node_from_reference;
    std::vector<std::uint32_t> component;
    std::uint32_t component_count = 0;
};

/// Chains the edges of a spanning forest (paper sec. "Robust Rotation Averaging").
/// @param forest  indices into edges
StartRotations rotations_of_forest(std::span<const RelativeRotation> edges,
                                   std::span<const std::uint32_t> forest, std::uint32_t node_count);

/// Joins parts in the order of the maximum spanning tree; but how two parts stand to each other is
/// decided by all edges between them: the rotation that edges of most weight agree on within
/// consensus_deg, and their mean; votes count weight^vote_power. One strong wrong edge cannot turn
/// two parts that many weaker right edges join (ours; docs/look-alikes.md). What was decided while
/// parts were small is asked again at the end (turn_parts). REQUIRES: as average_rotations
/// @param heaviest_first  all edges by index, strongest first
StartRotations rotations_by_consensus(std::span<const RelativeRotation> edges,
                                      std::span<const std::uint32_t> heaviest_first,
                                      std::uint32_t node_count,
                                      const RotationAveragingOptions& options);

}  // namespace psfm
