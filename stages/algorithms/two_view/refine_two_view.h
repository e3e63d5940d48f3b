// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>

#include "graph/rigid3.h"
#include "stages/algorithms/two_view/sampson.h"

namespace psfm {

struct RefineOptions {
    /// Scale of the Cauchy loss, in the unit of the points. Lower trusts fewer correspondences,
    /// higher lets wrong ones pull. Callers set it from VerifyOptions::refine_loss_px.
    double loss_scale = 1.0;
    /// Levenberg-Marquardt steps at most. Fewer is less exact; about five suffice from a RANSAC
    /// model.
    int max_iterations = 20;
    /// Stops when a step changes the cost by less than this share. Source: Ceres'
    /// function_tolerance.
    double cost_tolerance = 1e-6;
};

/// Intrinsic matrices (upper triangular, last element 1) of the two views, in the unit of the
/// points.
struct IntrinsicPair {
    Eigen::Matrix3d k1 = Eigen::Matrix3d::Identity();
    Eigen::Matrix3d k2 = Eigen::Matrix3d::Identity();
};

/// F = k2^-T [translation]x rotation k1^-1, so that x2' F x1 = 0 for points in the unit of k.
Eigen::Matrix3d fundamental_from_pose(const Rigid3& cam2_from_cam1,
                                      const IntrinsicPair& intrinsics);

/// Relative pose that minimises the robust Sampson error: Levenberg-Marquardt over rotation (3) and
/// direction of translation (2); ours, as the refinement in PoseLib's `refine_relpose`.
/// @param points  N >= 5 correspondences, in the unit of the intrinsic matrices
/// @return the refined cam2_from_cam1 with |translation| = 1; its cost is never above the start's
/// Deterministic. Thread-safe.
Rigid3 refine_relative_pose(std::span<const PointPair> points, const IntrinsicPair& intrinsics,
                            const Rigid3& cam2_from_cam1, const RefineOptions& options);

/// Fundamental matrix that minimises the robust Sampson error: Levenberg-Marquardt over the seven
/// parameters of f = U diag(1, s, 0) V' (Bartoli & Sturm, Nonlinear estimation of the fundamental
/// matrix with minimal parameters, PAMI 2004).
/// @param points  N >= 7 correspondences, best scaled to about unit size
/// @return rank 2, Frobenius norm 1; its cost is never above that of f's nearest rank-2 matrix
/// Deterministic. Thread-safe.
Eigen::Matrix3d refine_fundamental(std::span<const PointPair> points, const Eigen::Matrix3d& f,
                                   const RefineOptions& options);

/// Two unit vectors orthogonal to a unit vector and to each other.
Eigen::Matrix<double, 3, 2> tangent_basis(const Eigen::Vector3d& direction);

/// d vec(F) / d (rotation by exp(w) from the left, translation along tangent_basis), vec
/// column-major.
Eigen::Matrix<double, 9, 5> pose_jacobian(const Rigid3& cam2_from_cam1,
                                          const IntrinsicPair& intrinsics);

/// The pose moved by the five parameters of pose_jacobian; |translation| stays 1.
Rigid3 moved_pose(const Rigid3& cam2_from_cam1, const Eigen::Matrix<double, 5, 1>& step);

}  // namespace psfm
