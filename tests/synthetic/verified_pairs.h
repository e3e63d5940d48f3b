// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "graph/two_view_geometry.h"
#include "graph/view_graph.h"
#include "tests/synthetic/scene.h"

namespace psfm::synthetic {

struct VerifiedPairOptions {
    /// Pairs with fewer common points are no edges. Ours: the customary bar of COLMAP.
    std::uint32_t min_inliers = 15;
    /// E and kEssential when set, F and kFundamental when not (focal lengths taken as unknown).
    bool calibrated = true;
    /// Baselines below this part of the median depth count as pure rotations, and points whose
    /// thickness is below this part of their spread as planes. Ours.
    double degenerate_ratio = 1e-6;
};

/// [t]x R of a relative pose, Frobenius norm 1; zero when the translation is.
Eigen::Matrix3d essential_matrix(const Rigid3& cam2_from_cam1);

/// K2^-T E K1^-1, Frobenius norm 1.
Eigen::Matrix3d fundamental_matrix(const Rigid3& cam2_from_cam1, const Camera& camera1,
                                   const Camera& camera2);

/// Features of the same point, ascending. REQUIRES: pair.first, pair.second are images of the
/// scene.
std::vector<FeatureMatch> true_matches(const SyntheticScene& scene, ImagePair pair);

/// The pair with its true geometry and all its true matches: cam2_from_cam1 is the truth also when
/// the pair is uncalibrated. Where the points are a plane, kind is kPlanar; where the cameras stand
/// at one point, kPureRotation; the matrix is then the true homography.
VerifiedPair make_verified_pair(const SyntheticScene& scene, ImagePair pair,
                                const VerifiedPairOptions& options);

/// All pairs with enough common points, ascending. O(points * track length^2): pairs without a
/// common point cost nothing.
std::vector<VerifiedPairPtr> make_verified_pairs(const SyntheticScene& scene,
                                                 const VerifiedPairOptions& options = {});

/// Images 0 … image_count - 1, an edge a pair, weights the inlier counts.
ViewGraph make_view_graph(std::size_t image_count, const std::vector<VerifiedPairPtr>& pairs);

}  // namespace psfm::synthetic
