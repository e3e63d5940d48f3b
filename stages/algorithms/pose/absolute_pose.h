// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "graph/camera.h"
#include "graph/result.h"
#include "graph/rigid3.h"

namespace psfm {

struct AbsolutePoseOptions {
    /// Reprojection error of an inlier at most [px]. Higher: survives drift and bad intrinsics,
    /// lets in wrong matches. COLMAP 3.8's abs_pose_max_error.
    double max_error_px = 12.0;
    /// Fewer inliers are no pose. Lower: registers weak images, some of them wrongly. COLMAP 3.8
    /// asks for 30; ours, since matches here are verified and the pose is checked again after
    /// adjustment.
    std::uint32_t min_inliers = 20;
    /// COLMAP 3.8's abs_pose_min_inlier_ratio.
    double min_inlier_ratio = 0.25;
    int max_iterations = 10000;
};

Result<void> validate(const AbsolutePoseOptions& options);

struct AbsolutePose {
    Rigid3 cam_from_world;
    Camera camera;                       ///< as given, or with the focal length refined
    std::vector<std::uint32_t> inliers;  ///< indices of the correspondences, ascending
};

/// Pose of a camera from 2D-3D correspondences: P3P in a RANSAC (OpenCV's USAC), refined on the
/// inliers with a robust loss (paper, "Extend"). With `refine_focal` the focal length is searched
/// for around the camera's, since the first image of an unknown camera may be far off, and refined
/// with the pose.
/// @param pixels  N observations [px, distorted]
/// @param points  N points in the world
/// @errors kTooFewMatches (N or inliers below the options' bound), kDegenerate
/// Deterministic for equal inputs and seed. Thread-safe.
Result<AbsolutePose> estimate_absolute_pose(std::span<const Eigen::Vector2d> pixels,
                                            std::span<const Eigen::Vector3d> points,
                                            const Camera& camera, bool refine_focal,
                                            const AbsolutePoseOptions& options, std::uint64_t seed);

}  // namespace psfm
