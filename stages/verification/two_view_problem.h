// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "graph/camera.h"
#include "graph/image.h"
#include "graph/result.h"
#include "graph/two_view_geometry.h"
#include "stages/algorithms/two_view/refine_two_view.h"
#include "stages/algorithms/two_view/sampson.h"

namespace psfm {

/// Two views and their putative matches. Only views: what they show must outlive the struct.
struct MatchedViews {
    std::span<const Keypoint> keypoints1;
    std::span<const Keypoint> keypoints2;
    Camera camera1;
    Camera camera2;
    std::span<const FeatureMatch> matches;
};

/// The matched points of a pair, prepared once for all models.
/// Invariant: matches ascending; pixels and normalized belong to them, one each, all finite.
struct TwoViewProblem {
    std::vector<FeatureMatch> matches;
    std::vector<PointPair> pixels;      ///< undistorted pixels of a pinhole camera
    std::vector<PointPair> normalized;  ///< undistorted, z = 1
    IntrinsicPair intrinsics;           ///< of the pixels
    double cheirality_slack = 0.0;      ///< rays within this angle [rad] count as parallel
    bool calibrated = false;            ///< both focal lengths are known
};

/// Indices into a problem's matches, ascending.
using Indices = std::vector<std::uint32_t>;

/// Matches whose points cannot be undistorted are left out.
/// @param max_error_px  error of a match, from which the cheirality slack follows
/// @errors kInvalidArgument (a camera or a feature index that is not valid)
Result<TwoViewProblem> make_two_view_problem(const MatchedViews& views, double max_error_px);

/// Matches within max_error_px of the epipolar geometry f (pixels).
Indices inliers_of_fundamental(const TwoViewProblem& problem, const Eigen::Matrix3d& f,
                               double max_error_px);

/// Matches within max_error_px of the pose's epipolar geometry, and in front of both cameras.
Indices inliers_of_pose(const TwoViewProblem& problem, const Rigid3& cam2_from_cam1,
                        double max_error_px);

/// Matches whose points, turned by the rotation, fall within max_error_px of each other in both
/// images.
Indices inliers_of_rotation(const TwoViewProblem& problem, const Eigen::Quaterniond& rotation,
                            double max_error_px);

/// The points of some matches.
std::vector<PointPair> select(std::span<const PointPair> points,
                              std::span<const std::uint32_t> indices);

/// The inliers as feature matches; where a feature occurs twice on a side, only its first match is
/// kept.
std::vector<FeatureMatch> feature_matches(const TwoViewProblem& problem,
                                          std::span<const std::uint32_t> indices);

}  // namespace psfm
