// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>

namespace psfm {

/// What one edge says about how two parts of a graph stand to each other.
struct RotationVote {
    Eigen::Quaterniond rotation;
    double weight = 0.0;
};

enum class VoteCount : std::uint8_t {
    kAll,
    kBeyondStrongest,  ///< but for the strongest one: what a single edge says counts nothing
};

/// Weight of the votes within max_rad of a rotation.
double weight_for(const Eigen::Quaterniond& rotation, std::span<const RotationVote> votes,
                  double max_rad, VoteCount count);

/// The mean of the votes that agree with the one that most weight agrees with; of equal ones, the
/// first. REQUIRES: at least one vote, strongest first: only the strongest are candidates.
Eigen::Quaterniond consensus_of(std::span<const RotationVote> votes, double max_rad,
                                VoteCount count);

}  // namespace psfm
