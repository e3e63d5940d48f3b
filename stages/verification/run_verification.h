// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "graph/camera.h"
#include "graph/ids.h"
#include "graph/image.h"
#include "graph/result.h"
#include "graph/two_view_geometry.h"
#include "stages/algorithms/matching/descriptor_cells.h"
#include "stages/algorithms/matching/match_descriptors.h"
#include "stages/verification/verify_options.h"

namespace psfm {

/// What verification needs of one image.
/// Invariant: keypoints and descriptors are not null and have equally many rows.
struct ImageFeatures {
    ImageId id{};
    Camera camera;
    /// Decides the direction and the seed, whatever the arrival order. Distinct for distinct
    /// images.
    std::uint64_t content_hash = 0;
    std::shared_ptr<const Keypoints> keypoints;
    std::shared_ptr<const Descriptors> descriptors;
};

/// Gives a candidate's features when its turn comes, so that not all of them are in memory at once.
/// Called from several threads at the same time.
using FeatureLoader = std::function<Result<ImageFeatures>(ImageId)>;

/// A loader of features that are in memory already.
FeatureLoader loader_of(std::vector<ImageFeatures> images);

struct VerificationInput {
    ImageFeatures image;              ///< the new image
    std::vector<ImageId> candidates;  ///< other images; repeated ones count once
    FeatureLoader load;
    std::uint64_t seed = 0;
    /// Whether the candidates come most promising first; only then are enough_pairs enough.
    bool ranked = false;
};

struct VerificationOptions {
    MatchOptions match;
    CellOptions cells;
    VerifyOptions verify;
    /// Verified pairs after which the search among ranked candidates ends; 0: all are tried.
    /// Raised: time, and edges, grow in proportion where everything overlaps; lowered: fewer ways
    /// around a wrong pair, and shorter tracks. Source: ours, see docs/matching.md.
    std::size_t enough_pairs = 50;
};

Result<void> validate(const VerificationOptions& options);

struct VerificationStatistics {
    std::size_t tried = 0;  ///< candidates, without those that were not needed any more
    std::size_t verified = 0;
    std::size_t too_few_strongest = 0;  ///< hopeless by CellOptions::min_strongest_matches
    std::size_t too_few_matches = 0;
    std::size_t degenerate = 0;  ///< no geometry that enough matches agree with
    std::size_t still_only = 0;  ///< nothing but what stands still in both (is_still_only)
    std::size_t putative_matches = 0;
    std::size_t inliers = 0;
    double match_ms = 0.0;   ///< sum over pairs, not wall time
    double verify_ms = 0.0;  ///< likewise
};

struct VerificationOutput {
    /// Ascending by pair; those of still_only among them, which are known and are no edges.
    std::vector<VerifiedPairPtr> pairs;
    VerificationStatistics statistics;
};

/// Stage: one image against its candidates, pairs in parallel (TBB); ranked ones in rounds, the
/// first of options.enough_pairs, the others of as many as seem to be needed, a sixth to half of
/// these, until enough have been verified.
/// A pair's result depends on the two images' contents and cameras and on seed only: it is
/// verified in the direction of ascending content hash, then turned into the order of ids. Any
/// arrival order and any number of threads give the same pairs, poses inverted where ids are
/// exchanged. A pair that fails is counted, and is no error.
/// @errors kInvalidArgument (options, null or unequal features, a candidate equal to the image),
/// and
///   whatever the loader reports for the first candidate that it fails for; kInternal (an
///   exception)
Result<VerificationOutput> run_verification(const VerificationInput& input,
                                            const VerificationOptions& options);

/// The part of it for one pair with its matches, "1" being `a`; for matches that come from
/// elsewhere.
/// @param matches  first: feature of a, second: feature of b
/// @return geometry in the order (a, b);  @errors as verify_pair
/// Swapping a and b gives exactly the inverted geometry. Thread-safe.
Result<TwoViewGeometry> verify_images(const ImageFeatures& a, const ImageFeatures& b,
                                      std::span<const FeatureMatch> matches,
                                      const VerifyOptions& options, std::uint64_t seed);

}  // namespace psfm
