// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "graph/result.h"
#include "stages/algorithms/averaging/relative_direction.h"

namespace psfm {

struct DirectionFilterOptions {
    /// Axes on which the nodes are ordered. Raised: slower; lowered: scores that depend on chance.
    /// Wilson & Snavely 2014: 48.
    std::uint32_t axes = 48;
    /// Standard deviation of an axis about the direction of the edge that it is drawn from [deg],
    /// the bandwidth of the kernel density estimate. Raised: axes on which most edges are short and
    /// tell nothing. Lowered: the same axes again where all edges are parallel. Ours; not tuned.
    double bandwidth_deg = 10.0;
    /// An edge is dropped when its score is above this. Raised: wrong edges stay, some of which
    /// the robust losses that follow cope with; lowered: true edges with noise go. GTSfM's 0.1
    /// (OUTLIER_WEIGHT_THRESHOLD).
    double max_score = 0.1;
};

/// @errors kInvalidArgument
Result<void> validate(const DirectionFilterOptions& options);

struct DirectionFilter {
    std::vector<std::uint32_t> kept;  ///< indices of edges, ascending
    /// By edge: mean over the axes of the length that it runs backwards by, 0 where it does not. 0:
    /// in agreement with the others on each axis; at most 1.
    std::vector<double> score;
};

/// Outliers among directions by one-dimensional orderings (Wilson & Snavely, Robust Global
/// Translations with 1DSfM, ECCV 2014, sec. 3): projected on an axis, a direction only says which
/// of two nodes comes first, and how surely (its length there, times its weight). The order that
/// contradicts least of this, a minimum feedback arc set, is sought by the publication's greedy
/// rule: next comes a node that nothing unplaced comes before, else the one with the largest (1 +
/// what leaves it) / (1 + what enters it). Axes are drawn from a kernel density estimate of the
/// edges' directions. Differs from it in that weights of edges count in the ordering.
///
/// Edges that agree with one another are no outliers to it, however wrong, where nothing
/// contradicts them on any axis.
///
/// @errors kInvalidArgument (see check_directions)
/// Deterministic for equal inputs and seed. Thread-safe. O(axes * edges * log edges).
Result<DirectionFilter> filter_directions(std::span<const RelativeDirection> edges,
                                          std::uint32_t node_count,
                                          const DirectionFilterOptions& options,
                                          std::uint64_t seed);

}  // namespace psfm
