// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "graph/result.h"
#include "graph/two_view_geometry.h"

namespace psfm {

/// What of an image is no part of the scene, by all its pairs. Ours, tuned on datasets/cases and
/// rendered scenes, and not further (docs/verification.md, "What stands still").
struct StillFeatureOptions {
    /// Pairs that show a feature stand still while the scene moves, at least; 0: none is looked
    /// for, as in the paper. Raised: what is on the photograph itself stays in for longer; lowered:
    /// a passer-by before a camera that stood still takes the scene out.
    std::uint32_t min_pairs = 2;
    /// Pairs that show it move with the scene, at most this part of those that show it stand still.
    /// Raised: what the camera stood still before goes with the watermark; lowered: chance matches
    /// keep watermarks in.
    double max_moving = 0.25;
    /// A pair is no edge when fewer of its inliers, or a smaller part of them, are of the scene.
    std::uint32_t min_inliers = 15;
    double min_part = 0.5;
};

Result<void> validate(const StillFeatureOptions& options);

/// Whether the pair shows motion: fewer than half of its inliers are at one place in both images.
bool shows_motion(const TwoViewGeometry& geometry);

/// Features of an image that stand still in its pairs while the scene moves, ascending. One pair
/// cannot tell what the camera carries along from what is far away, or from what it stood still
/// before; several can. A function of the set of pairs: their order does not matter.
/// @param pairs  of the image
std::vector<std::uint32_t> still_features(ImageId image, std::span<const VerifiedPairPtr> pairs,
                                          const StillFeatureOptions& options);

/// A pair without the inliers that are no part of the scene: itself where there are none, null
/// where its geometry rests on them.
/// @param first, second  still_features of its images
VerifiedPairPtr without_still(const VerifiedPairPtr& pair, std::span<const std::uint32_t> first,
                              std::span<const std::uint32_t> second,
                              const StillFeatureOptions& options);

}  // namespace psfm
