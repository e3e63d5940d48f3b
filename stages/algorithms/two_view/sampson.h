// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>

namespace psfm {

/// Undistorted image points of one correspondence. The unit is the caller's: normalised, or pixels
/// of a pinhole camera, possibly scaled.
struct PointPair {
    Eigen::Vector2d x1 = Eigen::Vector2d::Zero();
    Eigen::Vector2d x2 = Eigen::Vector2d::Zero();
};

using Vector9d = Eigen::Matrix<double, 9, 1>;
using Matrix9d = Eigen::Matrix<double, 9, 9>;

/// Signed first-order distance of a correspondence from the epipolar geometry x2' f x1 = 0, in the
/// unit of the points (Sampson's error: Hartley & Zisserman, Multiple View Geometry, 2nd ed.,
/// eq. 11.9). Zero where the gradient vanishes (both points on the epipoles).
double sampson_residual(const Eigen::Matrix3d& f, const PointPair& points);

/// Robust Gauss-Newton system of the Sampson errors in the nine elements of f, in column-major
/// order. A parametrisation of f with Jacobian J (9 x k) has the normal equations J' information J
/// and J' gradient: the correspondences are visited once, whatever the parametrisation.
struct SampsonSystem {
    Matrix9d information = Matrix9d::Zero();
    Vector9d gradient = Vector9d::Zero();
    double cost = 0.0;  ///< sum of 1/2 loss(residual^2)
};

/// Cauchy loss: 1/2 s^2 log(1 + r^2 / s^2), with s = loss_scale in the unit of the points.
/// REQUIRES: loss_scale > 0. Thread-safe.
SampsonSystem linearize_sampson(std::span<const PointPair> points, const Eigen::Matrix3d& f,
                                double loss_scale);

/// Only the cost of linearize_sampson.
double sampson_cost(std::span<const PointPair> points, const Eigen::Matrix3d& f, double loss_scale);

/// [v]x with [v]x * w = v x w.
Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v);

}  // namespace psfm
