// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "graph/reconstruction.h"
#include "stages/reconstruction/model/doubt_options.h"

namespace psfm {

/// What two images of a model say of its being right.
struct ComparedPair {
    std::uint32_t first = 0;  ///< positions in Reconstruction::images, first < second
    std::uint32_t second = 0;
    std::uint32_t regions = 0;  ///< of either photograph where the other's points are expected
    std::uint32_t missing = 0;  ///< those of them where none of these is seen, though others are
};

/// Compares all pairs of images of a model by region. Look-alikes agree in all that is alike; what
/// stands beside them differs, and that shows in whole regions: points that one image has in common
/// with others are expected in the other image, at nearly the same angle and scale; neither it nor
/// one of its companions sees them, and it sees others there instead, no nearer. The missing
/// correspondences of Zach, Irschara & Bischof (CVPR 2008) and Jiang, Tan & Cheong (CVPR 2012),
/// counted in regions, since features get lost one by one in right models, too, and neighbours all
/// together only in wrong ones (ours).
/// @return pairs of which enough is expected, ascending by (first, second)
/// Cost: O(images^2 * points of an image). Deterministic on any number of threads. Thread-safe.
std::vector<ComparedPair> compare_by_region(const Reconstruction& model,
                                            const DoubtOptions& options);

/// Whether a pair contradicts its model.
bool contradicts(const ComparedPair& pair, const DoubtOptions& options);

}  // namespace psfm
