// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/adjustment/reprojection_cost.h"

#include <cmath>

namespace psfm {
namespace {

using RowMatrix23 = Eigen::Matrix<double, 2, 3, Eigen::RowMajor>;
using RowMatrix27 = Eigen::Matrix<double, 2, kPoseSize, Eigen::RowMajor>;
using RowMatrix28 = Eigen::Matrix<double, 2, kIntrinsicsSize, Eigen::RowMajor>;

Eigen::Quaterniond exponential(const Eigen::Vector3d& w) {
    const double angle = w.norm();
    // Guard: below, the next term of the series is less than the last digit.
    constexpr double kFewTerms = 1e-8;
    const double scale =
        angle < kFewTerms ? 0.5 - angle * angle / 48.0 : std::sin(0.5 * angle) / angle;
    Eigen::Quaterniond q;
    q.w() = std::cos(0.5 * angle);
    q.vec() = scale * w;
    return q;
}

}  // namespace

bool PoseManifold::Plus(const double* x, const double* delta, double* x_plus_delta) const {
    Eigen::Matrix<double, 6, 1> whole = Eigen::Matrix<double, 6, 1>::Zero();
    for (int i = 0, from = 0; i < 6; ++i) {
        if (i != held_) whole[i] = delta[from++];
    }
    const Eigen::Map<const Eigen::Quaterniond> rotation(x);
    const Eigen::Quaterniond moved = (exponential(whole.head<3>()) * rotation).normalized();
    Eigen::Map<Eigen::Vector4d>{x_plus_delta} = moved.coeffs();
    for (int i = 0; i < 3; ++i) x_plus_delta[4 + i] = x[4 + i] + whole[3 + i];
    return true;
}

bool PoseManifold::PlusJacobian(const double* /*x*/, double* jacobian) const {
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> matrix(
        jacobian, kPoseSize, TangentSize());
    matrix.setZero();
    for (int i = 0, column = 0; i < 6; ++i) {
        if (i != held_) matrix(i, column++) = 1.0;
    }
    return true;
}

bool PoseManifold::Minus(const double* y, const double* x, double* y_minus_x) const {
    const Eigen::Map<const Eigen::Quaterniond> to(y);
    const Eigen::Map<const Eigen::Quaterniond> from(x);
    const Eigen::AngleAxisd difference(to * from.conjugate());
    Eigen::Matrix<double, 6, 1> whole;
    whole.head<3>() = difference.angle() * difference.axis();
    for (int i = 0; i < 3; ++i) whole[3 + i] = y[4 + i] - x[4 + i];
    for (int i = 0, out = 0; i < 6; ++i) {
        if (i != held_) y_minus_x[out++] = whole[i];
    }
    return true;
}

bool PoseManifold::MinusJacobian(const double* /*x*/, double* jacobian) const {
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> matrix(
        jacobian, TangentSize(), kPoseSize);
    matrix.setZero();
    for (int i = 0, row = 0; i < 6; ++i) {
        if (i != held_) matrix(row++, i) = 1.0;
    }
    return true;
}

bool ReprojectionCost::Evaluate(double const* const* parameters, double* residuals,
                                double** jacobians) const {
    const PosedCamera camera(model_, parameters[0], parameters[2]);
    const Reprojection seen(camera, Eigen::Map<const Eigen::Vector3d>(parameters[1]));
    if (!seen.in_front()) return false;
    Eigen::Map<Eigen::Vector2d>{residuals} = inverse_sigma_ * (seen.pixel() - observed_);
    if (jacobians == nullptr) return true;
    ReprojectionDerivatives by;
    seen.derivatives(inverse_sigma_, by);
    if (jacobians[0] != nullptr)
        Eigen::Map<RowMatrix27>{jacobians[0]} << by.by_pose, Eigen::Vector2d::Zero();
    if (jacobians[1] != nullptr) Eigen::Map<RowMatrix23>{jacobians[1]} = by.by_point;
    if (jacobians[2] != nullptr) Eigen::Map<RowMatrix28>{jacobians[2]} = by.by_intrinsics;
    return true;
}

bool PrincipalPointPrior::Evaluate(double const* const* parameters, double* residuals,
                                   double** jacobians) const {
    for (int i = 0; i < 2; ++i)
        residuals[i] = inverse_sigma_ * (parameters[0][first_ + i] - centre_[i]);
    if (jacobians == nullptr || jacobians[0] == nullptr) return true;
    Eigen::Map<RowMatrix28> jacobian(jacobians[0]);
    jacobian.setZero();
    jacobian(0, first_) = inverse_sigma_;
    jacobian(1, first_ + 1) = inverse_sigma_;
    return true;
}

}  // namespace psfm
