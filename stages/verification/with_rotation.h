// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "stages/verification/verify_pair.h"

namespace psfm {

struct WithRotationOptions {
    /// Angle by which the refined pose may differ from the rotation that was asked for [deg].
    /// Raised: geometries of other places pass; lowered: inexact rotations explain nothing.
    double max_angle_deg = 10.0;
    /// Part of the pair's inliers that the pose must keep. Raised: pairs that were verified with a
    /// wrong focal length are lost; lowered: chance. Ours, not tuned: look-alikes keep next to
    /// none.
    double min_kept = 0.7;
    /// Sine of the angle off the plane of its rays at which a match counts half where the
    /// translation is fitted. Raised: wrong matches pull at it; lowered: it rests on what agreed
    /// from the beginning. Ours: half a degree, wider than any right match is off.
    double loss_scale = 0.01;
};

/// Whether a verified pair can be seen with another rotation than the one that it was given. Few
/// matches, planes and unknown focal lengths leave several poses to choose from, and the wrong one
/// is off by any angle although the matches are right: the images' other pairs know better. The
/// translation is the one that the rotation leaves to the matches (x2' [t] R x1 = 0, linear in t);
/// both are refined then, and inliers counted anew.
/// @param views  matches are ignored: the geometry's inliers are used
/// @return the geometry with that pose, its kind kEssential
/// @errors kDegenerate (too few of the inliers agree with any such pose), kInvalidArgument
/// Deterministic. Thread-safe.
Result<TwoViewGeometry> with_rotation(const TwoViewGeometry& geometry, const MatchedViews& views,
                                      const Eigen::Quaterniond& cam2_from_cam1_rotation,
                                      const VerifyOptions& verify,
                                      const WithRotationOptions& options);

}  // namespace psfm
