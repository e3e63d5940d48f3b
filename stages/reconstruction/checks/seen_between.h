// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "graph/reconstruction.h"
#include "stages/reconstruction/model/between_options.h"

namespace psfm {

/// What one of two images sees, and the other one stands so that it has to.
struct SeenBetween {
    std::uint32_t first = 0;  ///< positions in Reconstruction::images, first < second
    std::uint32_t second = 0;
    std::uint32_t expected = 0;  ///< points, both ways together
    std::uint32_t shared = 0;    ///< those of them that the other or one of its companions sees
    double shared_part() const { return static_cast<double>(shared) / expected; }
};

/// Asks for points that are seen from both sides of an image: two others see them, between whose
/// viewpoints its own one lies, in direction and in size, and nothing of its own is in front.
/// These are the missing correspondences of Zach, Irschara & Bischof (CVPR 2008) with nothing
/// extrapolated (ours): to one side of all who see a point it may be seen by nobody; between two of
/// them it is. And since one image loses every third point by chance, its companions are asked, too
/// (companions.h): what none of them sees is not there. So right models share nearly all, and
/// folded ones what is alike. A single image that stands wrongly shows in nothing: its companions
/// are those that it was wrongly joined to.
/// @param points_per_image  0: all points are looked at; else every so many-th, which counts for
/// these, so that an image sees about so many of them
/// @return pairs of which anything is expected, ascending by (first, second)
/// Deterministic on any number of threads. Thread-safe. Cost: O(images * points that those near an
/// image see * length of a track).
std::vector<SeenBetween> find_seen_between(const Reconstruction& model,
                                           const BetweenOptions& options,
                                           std::uint32_t points_per_image = 0);

}  // namespace psfm
