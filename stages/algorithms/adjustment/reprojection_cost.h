// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/manifold.h>
#include <ceres/sized_cost_function.h>

#include <Eigen/Core>
#include <cmath>

#include "graph/camera.h"
#include "graph/rigid3.h"

namespace psfm {

/// Format: parameter blocks of bundle adjustment: pose (quaternion x y z w, translation), point,
/// intrinsics (Camera::params).
constexpr int kPoseSize = 7;
constexpr int kPointSize = 3;
constexpr int kIntrinsicsSize = 8;

void write_pose(const Rigid3& cam_from_world, double* block);
Rigid3 read_pose(const double* block);

/// Rigid motion with the tangent (w, v): rotation' = exp(w) * rotation, translation' = translation
/// + v.
///
/// ReprojectionCost gives its derivatives by (w, v) in the first six of the seven columns and
/// leaves the last one zero; PlusJacobian is the matching [I6; 0], so nothing is computed through
/// the quaternion's four components. Use with cost functions of that convention only.
class PoseManifold final : public ceres::Manifold {
  public:
    PoseManifold() = default;
    /// Holds one coordinate of the translation (0 x, 1 y, 2 z), and with it the scale of a scene
    /// whose first camera is held, too.
    explicit PoseManifold(int held_translation) : held_(3 + held_translation) {}

    int AmbientSize() const override { return kPoseSize; }
    int TangentSize() const override { return held_ < 0 ? 6 : 5; }
    bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
    bool PlusJacobian(const double* x, double* jacobian) const override;
    bool Minus(const double* y, const double* x, double* y_minus_x) const override;
    bool MinusJacobian(const double* x, double* jacobian) const override;

  private:
    int held_ = -1;  // of the six coordinates (w, v); -1: none
};

/// Projected minus observed pixel, times `inverse_sigma`, of one observation; blocks as above.
/// @param jacobians  by pose (2 x 7 as PoseManifold wants it), point (2 x 3) and intrinsics (2 x
/// 8), row by row; null, or those that are null, are not computed
/// @return false when the point is not in front of the camera
bool evaluate_reprojection(CameraModel model, const Eigen::Vector2d& observed_px,
                           double inverse_sigma, const double* const* parameters, double* residuals,
                           double** jacobians);

/// The loss of bundle adjustment at one observation: soft L1, as ceres::SoftLOneLoss has it,
/// rho(s) = 2 b (sqrt(1 + s / b) - 1) for the squared error s and the squared scale b.
class SoftLOne {
  public:
    SoftLOne(double squared_error, double scale)
        : b_(scale * scale), root_(std::sqrt(1.0 + squared_error / b_)) {}
    /// rho / 2, what adds up to the cost.
    double half_loss() const { return b_ * (root_ - 1.0); }
    /// 1 / rho'. The curvature of the loss is negative, and left out of the normal equations, as
    /// Ceres does.
    double inverse_slope() const { return root_; }

  private:
    double b_;
    double root_;
};

/// Projected minus observed pixel, divided by the observation's standard deviation; analytic
/// derivatives.
class ReprojectionCost final
    : public ceres::SizedCostFunction<2, kPoseSize, kPointSize, kIntrinsicsSize> {
  public:
    ReprojectionCost(CameraModel model, const Eigen::Vector2d& observed_px, double sigma_px)
        : model_(model), observed_(observed_px), inverse_sigma_(1.0 / sigma_px) {}

    /// False when the point is not in front of the camera: the solver then takes a shorter step.
    bool Evaluate(double const* const* parameters, double* residuals,
                  double** jacobians) const override {
        return evaluate_reprojection(model_, observed_, inverse_sigma_, parameters, residuals,
                                     jacobians);
    }

  private:
    CameraModel model_;
    Eigen::Vector2d observed_;
    double inverse_sigma_;
};

/// Draws a principal point to the centre of the image: offset over its standard deviation.
class PrincipalPointPrior final : public ceres::SizedCostFunction<2, kIntrinsicsSize> {
  public:
    PrincipalPointPrior(const Camera& camera, double sigma_px)
        : first_(camera.has_two_focals() ? 2 : 1),
          centre_(0.5 * camera.width, 0.5 * camera.height),
          inverse_sigma_(1.0 / sigma_px) {}
    bool Evaluate(double const* const* parameters, double* residuals,
                  double** jacobians) const override;

  private:
    int first_;  // of the principal point's two slots
    Eigen::Vector2d centre_;
    double inverse_sigma_;
};

}  // namespace psfm
