// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "graph/two_view_geometry.h"
#include "stages/verification/two_view_problem.h"

namespace psfm {

/// Which part of the features that both images should show was matched: inliers over the features
/// of one image that an affine map, fitted to the inliers, takes into the other; the side with
/// fewer features counts. 1 at most.
///
/// Photographs of one place share most of what they both show, less the more their viewing
/// directions differ. Photographs of two places that look alike share what repeats and nothing
/// around it: on the temple (DATASETS.md) look-alikes reach a seventh of true neighbours of equal
/// triangulation angle, at any angle. The idea of missing correspondences: Zach, Irschara, Bischof,
/// What Can Missing Correspondences Tell Us about 3D Structure and Motion?, CVPR 2008. The measure
/// is ours. One affine map is a coarse model of parallax: the count of shared features is good to
/// some tens of per cent, which is far less than the difference that is looked for.
/// REQUIRES: inliers index the views' keypoints. Thread-safe.
double match_density(const MatchedViews& views, std::span<const FeatureMatch> inliers);

}  // namespace psfm
