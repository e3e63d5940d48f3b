// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "graph/reconstruction.h"
#include "stages/reconstruction/model/place_options.h"

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
/// @param points_per_image  0: all points are looked at; else every so many-th, which counts for
/// these, so that an image sees about so many of them
/// @return pairs with min_expected points, ascending by (first, second)
/// Deterministic on any number of threads. Thread-safe. Cost: O(images * max_neighbors * points of
/// an image that are looked at).
std::vector<SideBySide> find_side_by_side(const Reconstruction& model, const PlaceOptions& options,
                                          std::uint32_t points_per_image = 0);

/// Pairs that were found by some of the points, with all points counted. Cost: once through all
/// observations. Deterministic. Thread-safe.
/// @param pairs  of find_side_by_side() for this model and options
std::vector<SideBySide> count_all_points(const Reconstruction& model, const PlaceOptions& options,
                                         std::span<const SideBySide> pairs);

/// Whether one of some registered images stands beside an image that shares no more than a part of
/// what the first sees and the other should see: one way only, and by the depths of the first
/// alone. What find_side_by_side() would say of them at a fraction of the cost, erring towards
/// true. Deterministic. Thread-safe.
/// @param seen  points, among them all that the images observe
bool stand_beside_strangers(const Reconstruction& model, const ScenePoints& seen,
                            std::span<const ImageId> images, double max_shared_part,
                            const PlaceOptions& options);

}  // namespace psfm
