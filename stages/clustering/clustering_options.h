// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "graph/result.h"

namespace psfm {

/// Which images count as common neighbours of i and j in the distance d_ij.
enum class JaccardForm : std::uint8_t {
    /// i and j themselves as well: an edge adds 2 M_ij to the numerator. A triangle of equal edges
    /// has
    /// distance 0, so that a cluster can begin with its first edge. Ours (DESIGN.md section 3).
    kMutual,
    /// The paper's formula as printed: with M_ii = 0 a triangle of equal edges has distance 0.5,
    /// and a
    /// complete graph is a cluster at eta = 0.2 from seven images on.
    kLiteral,
};

struct ClusteringOptions {
    /// Images joined by an edge with d_ij < eta are in one cluster; [0, 1]. Raised: clusters join
    /// over weaker evidence, at 1 every component is one cluster. Lowered: more and smaller
    /// clusters, more left to merging. Paper, sec. "Implementation".
    double eta = 0.2;
    JaccardForm form = JaccardForm::kMutual;  ///< kLiteral with --preset paper
};

/// @errors kInvalidArgument
Result<void> validate(const ClusteringOptions& options);

}  // namespace psfm
