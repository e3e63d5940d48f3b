// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "graph/result.h"
#include "graph/two_view_geometry.h"

namespace psfm {

struct EdgeWeightOptions {
    /// Verified inliers a pair needs to be an edge of the view graph. Raised: sparse overlaps are
    /// lost, and with them images and the connections between clusters. Lowered: chance agreements
    /// and look-alikes become edges; at 15 every pair of the temple is one and clustering can no
    /// longer see anything (DATASETS.md). Ours, a compromise that figures bound but do not settle:
    /// a free fundamental matrix finds 40 to 60 inliers between temple images that share nothing,
    /// true neighbours there have 150 at 20 degrees and 63 at 30.
    ///
    /// The bar is absolute on purpose. A bar relative to an image's strongest
    /// edges would make edges come and go with later images, and each change would undo matches
    /// that the clusters are built on; how much an edge counts beside stronger ones is what the
    /// Jaccard distance weighs anyway.
    std::uint32_t min_inliers = 30;
};

Result<void> validate(const EdgeWeightOptions& options);

/// Weight M_ij of a verified pair in the view graph (paper sec. "Progressive Viewgraph").
/// @return number of inliers, or 0 when the pair is no edge. Depends on nothing but the pair, so
/// that an edge is the same in every order of arrival. Thread-safe.
double edge_weight(const TwoViewGeometry& geometry, const EdgeWeightOptions& options);

}  // namespace psfm
