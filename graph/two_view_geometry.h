// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "graph/ids.h"
#include "graph/rigid3.h"

namespace psfm {

/// Which model explained a pair best (persistent).
enum class TwoViewKind : std::uint8_t {
    kEssential = 0,     ///< calibrated, general scene
    kFundamental = 1,   ///< at least one focal length unknown, general scene
    kPlanar = 2,        ///< homography with parallax: the pair sees a plane
    kPureRotation = 3,  ///< homography without parallax: no translation can be had from it
};

/// Feature indices in the first and the second image of a pair.
struct FeatureMatch {
    std::uint32_t first = 0;
    std::uint32_t second = 0;
    auto operator<=>(const FeatureMatch&) const = default;
};

/// The verified geometry of an image pair; "1" is the pair's first image.
struct TwoViewGeometry {
    TwoViewKind kind = TwoViewKind::kEssential;
    /// x2' * matrix * x1 = 0 (E in normalised coordinates, F in undistorted pixels),
    /// or x2 ~ matrix * x1 (H in undistorted pixels). Frobenius norm 1.
    Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
    /// |translation| = 1, or 0 for kPureRotation. For unknown focal lengths: as with the cameras'
    /// guess.
    Rigid3 cam2_from_cam1;
    double median_angle_deg = 0.0;  ///< median triangulation angle of the inliers
    /// Part of the features that both images should show which was matched, and of those between
    /// the matches (their convex hull), 0 to 1; 0: unknown. See match_density.
    double match_density = 0.0;
    double core_density = 0.0;
    std::vector<FeatureMatch> inliers;  ///< ascending; each feature at most once a side
    /// Matches at one and the same pixel of both photographs, where there are many (find_still):
    /// far views, a camera that stood still, a watermark, the car's hood, what stands behind a
    /// turntable. Those that are inliers, too, agree with the scene's motion; the others do not.
    /// Ascending; each feature at most once a side.
    std::vector<FeatureMatch> still;
};

/// Whether a pair shows nothing but what stands still in both photographs, and that in a part of
/// them only: it says nothing of a scene, and is no edge.
inline bool is_still_only(const TwoViewGeometry& geometry) {
    return geometry.inliers.empty() && !geometry.still.empty();
}

/// What verification found of a pair: kept for ever, whether it is an edge at present or not.
struct VerifiedPair {
    ImagePair pair;
    TwoViewGeometry geometry;
};

using VerifiedPairPtr = std::shared_ptr<const VerifiedPair>;

}  // namespace psfm
