// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "graph/ids.h"
#include "graph/view_graph.h"
#include "stages/clustering/clustering_options.h"

namespace psfm {

/// Sum of an image's edge weights, added up in order of neighbours.
double weighted_degree(const ViewGraph& graph, ImageId image);

/// Weighted Jaccard distance of two images (paper sec. "Clustering"):
/// 1 - sum over common neighbours n of (M_in + M_nj) / sum over all n of (M_in + M_nj); 1 when
/// neither image has an edge. Bitwise symmetric in i and j and independent of the order in which
/// edges were added.
/// @return in [0, 1] up to rounding. Thread-safe.
double jaccard_distance(const ViewGraph& graph, ImageId i, ImageId j, JaccardForm form);

}  // namespace psfm
