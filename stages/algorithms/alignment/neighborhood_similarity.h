// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "graph/sim3.h"
#include "stages/algorithms/alignment/cluster_index.h"

namespace psfm {

/// Cameras with a nearest neighbour in their own model, and those that keep it when the two models
/// are laid into one; of large models estimates.
struct NeighborhoodCount {
    std::size_t kept = 0;
    std::size_t all = 0;

    /// The paper's s (sec. "Cluster Pose Estimation"); 1 when no camera counts.
    double similarity() const {
        return all == 0 ? 1.0 : static_cast<double>(kept) / static_cast<double>(all);
    }
};

/// Few are kept where models interleave: near cameras should have been in one cluster. Equal
/// distances count as kept; an image that is in both models is no neighbour of itself. Of a model
/// with more than a thousand cameras only some are asked, evenly, and stand for the others.
/// O(cameras asked * log).
NeighborhoodCount count_kept_neighbors(const ClusterIndex& a, const ClusterIndex& b,
                                       const Sim3& b_from_a);

}  // namespace psfm
