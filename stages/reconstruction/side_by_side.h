// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "graph/reconstruction.h"
#include "stages/reconstruction/place_options.h"

namespace psfm {

/// Two images that look from nearly one place in nearly one direction.
struct SideBySide {
    std::uint32_t first = 0;  ///< positions in Reconstruction::images, first < second
    std::uint32_t second = 0;
    std::uint32_t expected = 0;  ///< points that one sees and the other has in view, both ways
    std::uint32_t shared = 0;    ///< those of them that the other sees, too
    double shared_part() const { return static_cast<double>(shared) / expected; }
};

/// What a model says that images should share, and what they do share: the question of missing
/// correspondences (Zach, Irschara, Bischof, CVPR 2008), asked of the points of a model. Images
/// that stand side by side see the same whatever hides what, so no occlusion has to be known
/// (ours).
/// @return pairs with min_expected points, ascending by (first, second)
/// Deterministic on any number of threads. Thread-safe. Cost: O(images * max_neighbors * points of
/// an image).
std::vector<SideBySide> find_side_by_side(const Reconstruction& model, const PlaceOptions& options);

}  // namespace psfm
