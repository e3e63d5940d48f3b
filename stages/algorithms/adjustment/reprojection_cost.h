// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/manifold.h>
#include <ceres/sized_cost_function.h>

#include <Eigen/Core>

#include "graph/camera.h"
#include "stages/algorithms/adjustment/reprojection.h"

namespace psfm {

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

/// Projected minus observed pixel, divided by the observation's standard deviation; analytic
/// derivatives.
class ReprojectionCost final
    : public ceres::SizedCostFunction<2, kPoseSize, kPointSize, kIntrinsicsSize> {
  public:
    ReprojectionCost(CameraModel model, const Eigen::Vector2d& observed_px, double sigma_px)
        : model_(model), observed_(observed_px), inverse_sigma_(1.0 / sigma_px) {}

    /// False when the point is not in front of the camera: the solver then takes a shorter step.
    bool Evaluate(double const* const* parameters, double* residuals,
                  double** jacobians) const override;

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
