// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "graph/two_view_geometry.h"
#include "stages/verification/two_view_problem.h"

namespace psfm {

/// Which part of an image's features was matched, on the side where fewer could be; 1 at most.
struct MatchDensity {
    double shared = 0.0;  ///< of those that an affine map, fitted to the inliers, takes into the
                          ///< other image: what both should show
    double core = 0.0;    ///< of those inside the convex hull of the inliers
};

/// Photographs of one place share most of what they both show, less the more their viewing
/// directions differ. Photographs of two places that look alike share what repeats and nothing
/// around it: on the temple (temple-341 of docs/datasets.md) look-alikes reach a seventh of true
/// neighbours of equal triangulation angle, at any angle. The idea of missing correspondences:
/// Zach, Irschara, Bischof, What Can Missing Correspondences Tell Us about 3D Structure and
/// Motion?, CVPR 2008. The measure is ours. One affine map is a coarse model of parallax: the count
/// of shared features is good to some tens of per cent, which is far less than the difference that
/// is looked for. Where depths differ much, as on a walk down a street, the far end of it alone is
/// shared, and the affine map says little; there the core density is the better witness. REQUIRES:
/// inliers index the views' keypoints. Thread-safe.
MatchDensity match_density(const MatchedViews& views, std::span<const FeatureMatch> inliers);

}  // namespace psfm
