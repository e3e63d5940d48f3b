// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "graph/two_view_geometry.h"
#include "tests/synthetic/scene.h"

/// What goes wrong in the world, in steps of their own, so that a test says which of them it uses.
namespace psfm::synthetic {

/// Every keypoint moved by independent Gaussian noise in x and y. Keypoints may leave the image by
/// as much.
[[nodiscard]] SyntheticScene add_pixel_noise(SyntheticScene scene, double sigma_px,
                                             std::uint64_t seed);

/// `per_image` features that belong to no point, anywhere in each image, after its other features.
[[nodiscard]] SyntheticScene add_clutter(SyntheticScene scene, std::uint32_t per_image,
                                         std::uint64_t seed);

/// What is believed of the cameras before they are refined: focal lengths off by a Gaussian
/// relative error, no distortion, principal point at the centre, marked as `source`.
[[nodiscard]] std::map<CameraId, Camera> guessed_cameras(const SyntheticScene& scene,
                                                         double relative_focal_sigma,
                                                         FocalSource source, std::uint64_t seed);

struct WrongMatchOptions {
    /// Wrong matches in the result, as a part of all. Fewer when features run out (see
    /// add_clutter).
    double fraction = 0.2;
    /// When set, wrong partners lie within this distance of the epipolar line [px], as those do
    /// that geometric verification cannot tell from right ones.
    std::optional<double> max_epipolar_error_px = std::nullopt;
};

/// The matches and wrong ones between features that have no match, ascending; each feature stays at
/// most once a side.
[[nodiscard]] std::vector<FeatureMatch> add_wrong_matches(const SyntheticScene& scene,
                                                          ImagePair pair,
                                                          std::vector<FeatureMatch> matches,
                                                          const WrongMatchOptions& options,
                                                          std::uint64_t seed);

/// The same for the inliers of verified pairs; their geometry stays the true one.
[[nodiscard]] std::vector<VerifiedPairPtr> add_wrong_matches(
    const SyntheticScene& scene, const std::vector<VerifiedPairPtr>& pairs,
    const WrongMatchOptions& options, std::uint64_t seed);

}  // namespace psfm::synthetic
