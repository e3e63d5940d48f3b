// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "graph/rigid3.h"
#include "graph/two_view_geometry.h"
#include "tests/synthetic/look_alikes/look_alike_scene.h"

/// The matches between images of a LookAlikeScene, right and wrong ones.
namespace psfm::synthetic {

struct LookAlikeMatchOptions {
    /// Pairs whose largest group of matches that agree with one another is smaller are none.
    std::uint32_t min_matches = 15;
    /// Single wrong matches, as a part of all. They lie within max_epipolar_error_px of what most
    /// of the pair's matches tell, as those do that verification cannot tell from right ones.
    double wrong_part = 0.03;
    double max_epipolar_error_px = 2.0;
};

/// What a matcher finds between two images: features of equal look. A copy stands in only where the
/// point itself is not seen in both, and where neither image sees two of the same look (the ratio
/// test).
struct LookAlikePair {
    ImagePair pair;
    std::vector<FeatureMatch> matches;  ///< ascending; each feature at most once a side
    std::uint32_t right = 0;            ///< matches of features of the same point
    std::uint32_t copied = 0;           ///< matches between copies
    std::uint32_t wrong = 0;            ///< single wrong matches
    /// What the largest group of matches that agree with one another tells: the true relative pose,
    /// or that of the scene folded so that the copies coincide. Not scaled.
    Rigid3 cam2_from_cam1;
    bool folded = false;         ///< that group is one of copies
    std::uint32_t agreeing = 0;  ///< its size
};

/// Which features look alike, over all images. Immutable once made.
struct LookAlikeIndex {
    struct Sighting {
        std::uint32_t image = 0, feature = 0;
    };
    std::vector<std::uint32_t> first;  ///< sightings of a look: first[look] … first[look + 1] - 1
    std::vector<Sighting> sightings;   ///< of each look ascending
    /// Undistorted coordinates of the keypoints of each image, z = 1, by the true cameras.
    std::vector<std::vector<Eigen::Vector2f>> normalized;
};
LookAlikeIndex index_looks(const LookAlikeScene& scene);

/// The pairs of an image and later ones, ascending. O(features * images that see each look).
/// Deterministic for the scene's seed. Thread-safe.
std::vector<LookAlikePair> pairs_with_later(const LookAlikeScene& scene,
                                            const LookAlikeIndex& index, ImageId image,
                                            const LookAlikeMatchOptions& options);

}  // namespace psfm::synthetic
