// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "graph/result.h"
#include "stages/algorithms/matching/descriptor_cells.h"
#include "stages/algorithms/pose/absolute_pose.h"
#include "stages/features/run_features.h"
#include "stages/localisation/localisation_map.h"

namespace psfm {

struct LocaliseOptions {
    /// Features that vote for images, spread over all scales. Raised: slower; lowered: photographs
    /// of much detail are not recognised. Ours, chosen on quad-streams; no figure was kept.
    std::size_t voting_features = 512;
    /// Images of most votes that are matched. Raised: slower, about 10 ms each; lowered:
    /// where look-alikes have most votes the right ones are missed. Ours, as above.
    std::size_t images = 20;
    /// Matches with an image below which it says nothing. As VerifyOptions::min_inliers.
    std::size_t min_matches = 10;
    MatchOptions match;
    /// As of verification: a seventh of the comparisons, and nearly all matches.
    CellOptions cells;
    /// Images with most matches whose surroundings are tried by themselves. Raised: slower, a pose
    /// each; lowered: where look-alikes have most matches the right ones are missed. Ours; not
    /// tuned.
    std::size_t surroundings = 5;
    /// Points that an image of the surroundings has in common with the one that they are of.
    /// Raised: poses rest on fewer images; lowered: look-alikes come along. Ours; not tuned.
    std::size_t min_shared_points = 5;
    /// Of all correspondences with several images, many of which may be look-alikes, fewer are
    /// right than of verified pairs.
    AbsolutePoseOptions pose{.max_error_px = 8.0, .min_inliers = 20, .min_inlier_ratio = 0.1};
};

/// An image of the session that a photograph shares points with.
struct SeenImage {
    ImageId image{};
    std::uint32_t matches = 0;
    std::uint32_t inliers = 0;  ///< that agree with the pose
};

struct LocalisedPhoto {
    std::uint32_t part = 0;
    Rigid3 cam_from_world;
    Camera camera;  ///< as given, or with its focal length refined
    std::optional<Eigen::Matrix<double, 6, 6>> covariance;  ///< see pose_covariance.h
    std::uint32_t inliers = 0;
    std::uint32_t correspondences = 0;
    double median_error_px = 0.0;   ///< of the inliers
    std::vector<SeenImage> images;  ///< with inliers, most first
};

/// Descriptors of an image of the session. Called from several threads at once.
using MapDescriptors = std::function<Result<std::shared_ptr<const Descriptors>>(ImageId)>;

/// Where a photograph was taken: images are recognised by votes of features (LocalisationMap), the
/// best of them matched in full, and the pose is P3P on the points of what matches, with all of
/// them and with each image's own surroundings, since a look-alike may have matches, too; most
/// inliers count.
/// @param camera  of the photograph. @param refine_focal  its focal length is a guess
/// @errors kTooFewMatches, kDegenerate: with the reason, for people; those of `descriptors`
/// Deterministic, on any number of threads. Uses the caller's TBB arena. Thread-safe.
Result<LocalisedPhoto> localise_photo(const LocalisationMap& map, const ExtractedPhoto& photo,
                                      const Camera& camera, bool refine_focal,
                                      const MapDescriptors& descriptors,
                                      const LocaliseOptions& options);

}  // namespace psfm
