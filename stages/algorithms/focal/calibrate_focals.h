// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <span>

#include "graph/camera.h"
#include "graph/ids.h"
#include "graph/image.h"
#include "graph/result.h"
#include "graph/two_view_geometry.h"

namespace psfm {

struct FocalCalibrationOptions {
    /// Fewest inliers of a pair that counts. Raised: wide baselines, which tell most, are left out;
    /// lowered: accidental geometry votes. Source: ours; not tuned: twice COLMAP's
    /// min_num_inliers.
    std::size_t min_pair_inliers = 30;
    /// Correspondences taken of a pair, evenly spread over its inliers. Raised: slower, and strong
    /// pairs drown the others; lowered: noise. Source: ours, on Strecha's scenes
    /// (docs/verification.md).
    std::size_t max_pair_points = 200;
    /// Pairs taken at most, those that tell most first. Raised: slower (about 0.05 ms a pair and
    /// step). Source: ours; not tuned.
    std::size_t max_pairs = 500;
    /// Focal lengths that are tried, over the longer side of the photograph: views of 118 to 14
    /// degrees. Raised and lowered: fisheyes, long telephotos are missed. Source: ours; not tuned.
    double min_relative_focal = 0.3;
    double max_relative_focal = 4.0;
    /// Width of a pair's vote, as (s1 - s2) / (s1 + s2) of its essential matrix's singular values.
    /// Raised: vaguer votes; lowered: fewer of them meet. Source: ours, on Strecha's scenes
    /// (docs/verification.md), as are the next three.
    double vote_width = 0.02;
    /// Scale of the Cauchy loss on the Sampson errors [px]. Source: ours, on Strecha's scenes.
    double loss_px = 0.5;
    /// A pair whose mean cost a point [loss_px^2] reaches this weighs a quarter. Raised: wrong
    /// pairs pull; lowered: only near-perfect ones count. Source: ours, on Strecha's scenes.
    double pair_loss = 0.3;
    /// Expected relative deviation of a camera from the others with photographs of its size.
    /// Raised: photographs that say little drift; lowered: different lenses are drawn together.
    /// Source: ours, on Strecha's scenes.
    double spread = 0.1;
    /// Where the common focal length of one photograph size is expected, over its longer side, and
    /// with which deviation of its logarithm. Lowered deviation: pairs that know better are
    /// overruled; raised: sizes with few pairs drift. Source: COLMAP's default_focal_length_factor;
    /// the deviation is not tuned, one good pair overrules it.
    double expected_relative_focal = 1.2;
    double expected_deviation = 0.7;
    /// Triangulation angle of a pair above which a wider one tells no more [deg]. Raised: a few
    /// wide pairs are taken first; lowered: narrow ones, which tell little. Source: not tuned.
    double wide_angle_deg = 20.0;
    /// Relative uncertainty above which a camera is left at its guess. Source: ours; not tuned.
    double max_uncertainty = 0.2;
    /// Steps of the joint refinement at most. Source: ours; not tuned: most scenes need ten.
    int max_iterations = 30;
};

Result<void> validate(const FocalCalibrationOptions& options);

/// What is known of one camera after calibration.
struct CalibratedFocal {
    double focal_px = 0.0;
    std::size_t pairs = 0;  ///< pairs of its photographs that took part
    double uncertainty =
        0.0;  ///< relative standard deviation if errors were independent: a lower bound
};

struct FocalCalibration {
    /// Cameras whose focal length was estimated. One with FocalSource::kUnknown that is missing
    /// here had no evidence: leave it at its guess.
    std::map<CameraId, CalibratedFocal> focals;
    std::size_t pairs = 0;  ///< pairs that took part
};

/// Keypoints of an image; an empty span when they are not at hand.
using KeypointsOf = std::function<std::span<const Keypoint>(ImageId)>;

/// Focal lengths of the cameras with FocalSource::kUnknown from all fundamental matrices together;
/// known cameras are held. In three steps, each the start of the next:
/// 1. cameras of one photograph size vote for a common focal length: a fundamental matrix fits
/// where its
///    essential matrix has two equal singular values (Mendonca & Cipolla, CVPR 1999);
/// 2. the common focal length and the relative pose of each pair minimise the robust Sampson errors
/// of the
///    correspondences themselves (ours; a bundle adjustment of pairs with the points eliminated);
/// 3. the same with a focal length for each camera, drawn weakly to the common one.
/// Without keypoints step 1 is all there is. Measured with SIFT on Strecha's four scenes
/// (docs/verification.md): 1: 0.3 to 4.3 % off, 2: 0.2 to 0.8 %, 3: median 0.3 to 2.7 %,
/// largest 4.7 %. Radial distortion that the cameras do not tell of shifts the result: k1 = +-0.05
/// by 2 to 10 %.
/// @param pairs    kinds other than kFundamental, and images without a camera, are passed over
/// @param cameras  as the pairs were verified with
/// @errors kInvalidArgument (options, cameras)
/// Deterministic for equal inputs; the order of pairs does not matter. Thread-safe.
Result<FocalCalibration> calibrate_focals(std::span<const VerifiedPairPtr> pairs,
                                          const std::map<CameraId, Camera>& cameras,
                                          const std::map<ImageId, CameraId>& camera_of,
                                          const FocalCalibrationOptions& options,
                                          const KeypointsOf& keypoints_of = {});

}  // namespace psfm
