// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "graph/camera.h"
#include "graph/result.h"

namespace psfm {

/// What does not move from one photograph to another, and whether it is of the scene. Ours, all of
/// it, tuned on datasets/cases and rendered scenes; docs/verification.md, "What stands still", has
/// figures of min_matches and max_motion_px, the others were not tuned further.
struct StillOptions {
    /// Fewest matches at one place for which a pair is looked at twice; 0: none is, as in the
    /// paper. Raised: small watermarks count as scene; lowered: chance costs time.
    std::size_t min_matches = 8;
    /// Matches that move by less lie at one place [px, up to exact_side_px]. Raised: slow motion is
    /// taken for none; lowered: compression moves what stands still.
    double max_motion_px = 1.0;
    /// In larger photographs, features are found as much less exactly as their longer side is
    /// longer [px].
    double exact_side_px = 1600.0;
    /// Those are of one scale and orientation, too. Raised: matches of other things; lowered: what
    /// shines through a watermark turns its features.
    double max_scale_ratio = 1.25;
    double max_turn_deg = 15.0;
    /// What moves is a scene of its own when this part of the matches that move agrees, where those
    /// that do not move are everywhere. Raised: objects before a background that stands still are
    /// overlooked; lowered: wrong matches between two photographs from a tripod make a scene.
    double min_moving_share = 0.3;
    /// Matches that do not move are of the scene, as far views are, when this part of them agrees
    /// with its motion, and the scene's agrees with theirs. Raised: far views are lost; lowered:
    /// watermarks stay in.
    double min_agreeing = 0.5;
    /// Where nothing moves, the camera stood still if matches lie in this part of what has features
    /// (still_coverage). Raised: photographs from a tripod before which much has moved lose each
    /// other; lowered: a hood or a frame passes for a view.
    double min_coverage = 0.5;
    /// Squares along each side by which that is counted. Raised: single matches cover less;
    /// lowered: a logo in a corner covers a view. Not tuned.
    std::uint32_t coverage_grid = 8;
    /// Far views: the pair's geometry stays that of all its matches when this part of those that
    /// move agrees with it. Raised: far views are lost where they say most; lowered: what stands
    /// still bends the pair. Not tuned.
    double min_kept = 0.8;
};

Result<void> validate(const StillOptions& options);

struct VerifyOptions {
    /// Largest Sampson (E, F) or symmetric transfer (H) error of an inlier [px of the photograph],
    /// where both focal lengths are known. Raised: wrong matches pass and wrong pairs gather
    /// inliers; lowered: inexact intrinsics lose true ones. Source: ours, tuned on Strecha's four
    /// scenes (docs/verification.md). COLMAP's 4 px verifies twice as many wrong pairs there and a
    /// few more true ones.
    double max_error_px = 2.0;
    /// The same where a focal length is not known: nor is the distortion then, which bends epipolar
    /// lines. Lowered: wide pairs lose their few matches; `kitchen` has 19 of 25 placed with 2 px,
    /// and all with 3. Ours, on `kitchen`.
    double max_uncalibrated_error_px = 3.0;
    /// Scale of the Cauchy loss in the refinement [px]. Raised: coarse matches pull the pose;
    /// lowered: the pose rests on few matches and the refinement finds local minima. Source: ours,
    /// on Strecha's scenes (docs/verification.md).
    double refine_loss_px = 0.3;
    /// Fewest inliers of a verified pair. Source: COLMAP's min_num_inliers.
    int min_inliers = 15;
    /// Least share of the putative matches that must be inliers. Raised: pairs with little overlap
    /// are lost; lowered: wrong pairs pass, and RANSAC takes longer to give up. On Strecha's scenes
    /// 0.15 verifies 3 more true pairs than 0.25 and 26 more wrong ones, which have few inliers and
    /// are weak edges at most; `kitchen` needs true pairs below 0.25. Ours, on these
    /// (docs/verification.md).
    double min_inlier_ratio = 0.1;
    /// Share of the epipolar inliers that a homography must hold to explain the pair: then the
    /// scene is planar or the camera only turned. Source: COLMAP's max_H_inlier_ratio.
    double homography_ratio = 0.8;
    /// Share of the homography's inliers that a mere rotation must hold for kPureRotation. Raised:
    /// short baselines get an arbitrary direction; lowered: usable ones lose theirs. Source: ours
    /// (docs/verification.md).
    double rotation_ratio = 0.8;
    /// Probability of having drawn one clean sample when RANSAC stops. Source: COLMAP.
    double confidence = 0.999;
    /// RANSAC iterations at most. Raised: wrong pairs take longer (about 15 us each), and more of
    /// them pass; lowered: pairs with many wrong matches are missed. Source: ours, on Strecha's
    /// scenes: 10000 finds 199 true pairs where this finds 197, and takes six times as long over
    /// wrong ones.
    int max_iterations = 1000;
    StillOptions still;
};

Result<void> validate(const VerifyOptions& options);

/// The options for a pair of cameras: max_error_px is the one that they ask for.
VerifyOptions options_for(const VerifyOptions& options, const Camera& camera1,
                          const Camera& camera2);

}  // namespace psfm
