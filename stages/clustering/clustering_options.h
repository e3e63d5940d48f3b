// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "graph/result.h"

namespace psfm {

/// Which images count as common neighbours of i and j in the distance d_ij.
enum class JaccardForm : std::uint8_t {
    /// i and j themselves as well: an edge adds 2 M_ij to the numerator. A triangle of equal edges
    /// has
    /// distance 0, so that a cluster can begin with its first edge. Ours (docs/design.md).
    kMutual,
    /// The paper's formula as printed: with M_ii = 0 a triangle of equal edges has distance 0.5,
    /// and a complete graph is a cluster at eta = 0.2 from seven images on.
    kLiteral,
};

struct ClusteringOptions {
    /// Images joined by an edge with d_ij < eta are in one cluster; [0, 1]. Raised: clusters join
    /// over weaker evidence, at 1 every component is one cluster. Lowered: more and smaller
    /// clusters, more left to merging. Paper, sec. "Implementation".
    double eta = 0.2;
    JaccardForm form = JaccardForm::kMutual;  ///< kLiteral with --preset paper
    /// Clusters of fewer images join what they share their strongest edge with once no more images
    /// come (join_late); 0: they stay by themselves, as in the paper. Raised: thin parts are
    /// reconstructed together, and look-alikes among them come apart only by what the model shows;
    /// lowered: images wait for ever that one model of all of them would place. Ours: the paper's
    /// mu_min would do for what waits; twice that puts `kitchen` into one part; not tuned
    /// further.
    std::uint32_t join_below = 10;
    /// Clusters that together have more images, each of them at least `hold_part` of so many, are
    /// joined only by join_late, when no more images come: until then what happens in one of them
    /// costs what it does in a cluster of this size, they are solved side by side, and merging puts
    /// them into one frame. Raised: joints of thousands of images while images stream in; lowered:
    /// what is seen from two clusters is known less well in between. 0: all are joined at once, as
    /// in the paper. Ours (docs/performance.md).
    std::uint32_t join_up_to = 1000;
    /// A cluster of fewer images than this part of join_up_to, or a single one, joins one of any
    /// size; (0, 1]. Raised: joints with large clusters more often; lowered: more small clusters
    /// beside them. Ours; not tuned.
    double hold_part = 0.1;
};

/// Whether clusters of so many images, at least one each, are joined at once.
bool may_join(std::size_t a, std::size_t b, const ClusteringOptions& options);

/// Whether so many images are enough for a model. Paper: mu_min.
inline bool makes_model(std::size_t images, std::uint32_t mu_min) {
    return images >= mu_min;
}

/// @errors kInvalidArgument
Result<void> validate(const ClusteringOptions& options);

}  // namespace psfm
