// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "graph/two_view_geometry.h"
#include "stages/algorithms/alignment/alignment_options.h"
#include "stages/algorithms/alignment/cluster_constraint.h"
#include "stages/algorithms/alignment/cluster_index.h"

namespace psfm {

/// The similarity between two clusters, in the paper's two stages (sec. "Cluster Pose Estimation"):
/// each edge gives one by RANSAC, and is an outlier if too few of its points agree or the
/// neighbourhood similarity is below lambda_s; the final one is estimated from all correspondences
/// of the edges that are left.
/// @param before  an earlier constraint of the same clusters by the same options, of which what
///                rests on the same views and points is taken over; may be null, for the same
///                result
/// @return verdict and numbers; ids and revisions are the caller's to fill in
/// Deterministic: seeds come from the edges' matches. Thread-safe; edges in parallel (TBB).
ClusterConstraint estimate_cluster_constraint(const ClusterIndex& a, const ClusterIndex& b,
                                              std::span<const VerifiedPairPtr> edges,
                                              const ClusterConstraintOptions& options,
                                              const ClusterConstraint* before = nullptr);

}  // namespace psfm
