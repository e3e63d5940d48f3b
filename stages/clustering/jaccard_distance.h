// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "graph/ids.h"
#include "graph/view_graph.h"
#include "stages/clustering/clustering_options.h"

namespace psfm {

/// Sum of an image's edge weights, added up in order of neighbours.
double weighted_degree(const ViewGraph& graph, ImageId image);

/// The two sums of the weighted Jaccard distance (paper sec. "Clustering").
struct JaccardSums {
    double shared = 0.0;  ///< over common neighbours n: M_in + M_nj; by form, plus 2 M_ij
    double all = 0.0;     ///< over all n: M_in + M_nj

    /// In [0, 1] up to rounding; 1 when neither image has an edge.
    double distance() const { return all > 0.0 ? 1.0 - shared / all : 1.0; }
    /// distance() < eta, but without the rounding of 1 - 0.8, so that distances which equal eta do
    /// not join.
    bool nearer_than(double eta) const { return shared > (1.0 - eta) * all; }
};

/// @param common sum over common neighbours n, ascending, of (M_in + M_nj)
/// @param direct M_ij, 0 without an edge; @param degrees weighted degrees of i and j together
inline JaccardSums jaccard_sums(double common, double direct, double degrees, JaccardForm form) {
    return {form == JaccardForm::kMutual ? common + 2.0 * direct : common, degrees};
}

/// Sums of two images: bitwise symmetric in i and j, and for whole weights (numbers of inliers)
/// exact, hence independent of the order of arrival. Thread-safe.
JaccardSums jaccard_sums(const ViewGraph& graph, ImageId i, ImageId j, JaccardForm form);

}  // namespace psfm
