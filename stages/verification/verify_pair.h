// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "graph/result.h"
#include "graph/two_view_geometry.h"
#include "stages/verification/two_view_problem.h"
#include "stages/verification/verify_options.h"

namespace psfm {

/// The geometry of two views from their putative matches: an essential matrix when both focal
/// lengths are known, else a fundamental matrix; a homography always; the kind is the one that the
/// inliers ask for (COLMAP's two_view_geometry.cc, after Schoenberger & Frahm, CVPR 2016,
/// sec. 4.1). Differs in:
/// - RANSAC's model is refined on its inliers (robust Sampson error), twice, and the inliers are
///   counted anew. On the Strecha photographs that divides the median rotation error by five.
/// - inliers lie in front of both cameras;
/// - planar pairs of known cameras choose among the homography's poses and the essential matrix's
/// by
///   the refined pose, and keep the inliers off the plane;
/// - where many matches lie at one place of both images (find_still), the others are asked first.
///   Where these have a motion of their own that the still ones do not share, the geometry is
///   theirs, and no still match that contradicts it is an inlier. Where nothing else moves, the
///   camera stood still if they lie all over the photographs: the pair is a rotation by nothing, or
///   what it was without this. Else they are no view of anything, and the geometry has no inliers
///   (is_still_only).
/// @return "1" is the views' first image; TwoViewGeometry::still is find_still's. Inliers lie
/// within
///   max_error_px of the geometry. With an unknown focal length the pose is that of the cameras'
///   guess (see with_intrinsics).
/// @errors kTooFewMatches (fewer than min_inliers), kDegenerate (no model has min_inliers and
///   min_inlier_ratio, or those that agree lie on one line), kInvalidArgument (options, cameras,
///   feature indices)
/// Deterministic for equal inputs and seed; the order of the matches does not matter. Thread-safe.
Result<TwoViewGeometry> verify_pair(const MatchedViews& views, const VerifyOptions& options,
                                    std::uint64_t seed);

/// A verified pair seen through other intrinsics, as after calibrate_focals: the pose follows from
/// the stored matrix (E = K2' F K1), is refined on the stored inliers, and its kind is kEssential
/// when both focal lengths are now known and the pair was not planar. Pure rotations keep no
/// translation.
/// @param views  matches are ignored: the geometry's inliers are used
/// @param geometry  its matrix must come from cameras with the same distortion
/// @return inliers: those of the geometry that agree with the pose
/// @errors kDegenerate (fewer than min_inliers agree), kInvalidArgument
/// Deterministic. Thread-safe.
Result<TwoViewGeometry> with_intrinsics(const TwoViewGeometry& geometry, const MatchedViews& views,
                                        const VerifyOptions& options);

}  // namespace psfm
