// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "stages/algorithms/matching/dot_kernel.h"
#include "stages/algorithms/matching/match_descriptors.h"

namespace psfm {

/// What MatchOptions ask of two descriptors, in the numbers that kernels give: squared distances
/// that lack the squared norm of the descriptor whose neighbours they are.
class MatchCriteria {
  public:
    explicit MatchCriteria(const MatchOptions& options)
        : max_squared_ratio_(options.max_ratio * options.max_ratio),
          max_squared_(options.max_distance * options.max_distance * kUnit * kUnit) {}

    static double squared(std::int32_t value, std::int32_t own_norm) {
        return static_cast<double>(value) + static_cast<double>(own_norm);
    }
    bool near_enough(double squared_distance) const { return squared_distance <= max_squared_; }
    /// Whether the second nearest neighbour of a descriptor is far enough behind its nearest.
    bool distinct(double best, std::int32_t second, std::int32_t own_norm) const {
        return second == kNoDistance || best < max_squared_ratio_ * squared(second, own_norm);
    }

    /// Format: RootSIFT bytes of a descriptor of length 1 have Euclidean length 512
    /// (graph/image.h).
    static constexpr double kUnit = 512.0;

  private:
    double max_squared_ratio_;
    double max_squared_;
};

}  // namespace psfm
