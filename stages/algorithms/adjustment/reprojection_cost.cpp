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
    const double scale = angle < 1e-8 ? 0.5 - angle * angle / 48.0 : std::sin(0.5 * angle) / angle;
    Eigen::Quaterniond q;
    q.w() = std::cos(0.5 * angle);
    q.vec() = scale * w;
    return q;
}

Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
    Eigen::Matrix3d m;
    m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
    return m;
}

/// A pixel with its derivatives by the normalised coordinates and by the intrinsics.
struct PixelDerivatives {
    Eigen::Vector2d pixel;
    Eigen::Matrix2d by_normalized;
    RowMatrix28 by_intrinsics = RowMatrix28::Zero();
};

PixelDerivatives one_focal(const double* p, const Eigen::Vector2d& x, double k1, double k2,
                           int radial_terms) {
    const double f = p[0];
    const double r2 = x.squaredNorm();
    const double factor = 1.0 + k1 * r2 + k2 * r2 * r2;
    PixelDerivatives out;
    out.pixel = Eigen::Vector2d(p[1], p[2]) + f * factor * x;
    out.by_normalized =
        f * (factor * Eigen::Matrix2d::Identity() + (2.0 * k1 + 4.0 * k2 * r2) * x * x.transpose());
    out.by_intrinsics.col(0) = factor * x;
    out.by_intrinsics(0, 1) = 1.0;
    out.by_intrinsics(1, 2) = 1.0;
    if (radial_terms > 0) out.by_intrinsics.col(3) = f * r2 * x;
    if (radial_terms > 1) out.by_intrinsics.col(4) = f * r2 * r2 * x;
    return out;
}

PixelDerivatives two_focals(const double* p, const Eigen::Vector2d& x, bool distorted) {
    const Eigen::Vector2d f(p[0], p[1]);
    const double k1 = distorted ? p[4] : 0.0;
    const double k2 = distorted ? p[5] : 0.0;
    const double p1 = distorted ? p[6] : 0.0;
    const double p2 = distorted ? p[7] : 0.0;
    const double r2 = x.squaredNorm();
    const double xy = x.x() * x.y();
    const Eigen::Vector2d tangential1(2.0 * xy, r2 + 2.0 * x.y() * x.y());
    const Eigen::Vector2d tangential2(r2 + 2.0 * x.x() * x.x(), 2.0 * xy);
    const double factor = 1.0 + k1 * r2 + k2 * r2 * r2;
    const Eigen::Vector2d bent = factor * x + p1 * tangential1 + p2 * tangential2;
    Eigen::Matrix2d by_x =
        factor * Eigen::Matrix2d::Identity() + (2.0 * k1 + 4.0 * k2 * r2) * x * x.transpose();
    by_x(0, 0) += 2.0 * p1 * x.y() + 6.0 * p2 * x.x();
    by_x(0, 1) += 2.0 * p1 * x.x() + 2.0 * p2 * x.y();
    by_x(1, 0) += 2.0 * p2 * x.y() + 2.0 * p1 * x.x();
    by_x(1, 1) += 2.0 * p2 * x.x() + 6.0 * p1 * x.y();
    PixelDerivatives out;
    out.pixel = Eigen::Vector2d(p[2], p[3]) + f.cwiseProduct(bent);
    out.by_normalized = f.asDiagonal() * by_x;
    out.by_intrinsics(0, 0) = bent.x();
    out.by_intrinsics(1, 1) = bent.y();
    out.by_intrinsics(0, 2) = 1.0;
    out.by_intrinsics(1, 3) = 1.0;
    if (distorted) {
        out.by_intrinsics.col(4) = f.cwiseProduct(r2 * x);
        out.by_intrinsics.col(5) = f.cwiseProduct(r2 * r2 * x);
        out.by_intrinsics.col(6) = f.cwiseProduct(tangential1);
        out.by_intrinsics.col(7) = f.cwiseProduct(tangential2);
    }
    return out;
}

PixelDerivatives evaluate_camera(CameraModel model, const double* p, const Eigen::Vector2d& x) {
    switch (model) {
        case CameraModel::kSimplePinhole:
            return one_focal(p, x, 0.0, 0.0, 0);
        case CameraModel::kSimpleRadial:
            return one_focal(p, x, p[3], 0.0, 1);
        case CameraModel::kRadial:
            return one_focal(p, x, p[3], p[4], 2);
        case CameraModel::kPinhole:
            return two_focals(p, x, false);
        case CameraModel::kOpenCv:
            return two_focals(p, x, true);
    }
    return {};
}

}  // namespace

void write_pose(const Rigid3& cam_from_world, double* block) {
    Eigen::Map<Eigen::Vector4d>{block} = cam_from_world.rotation.coeffs();
    Eigen::Map<Eigen::Vector3d>{block + 4} = cam_from_world.translation;
}

Rigid3 read_pose(const double* block) {
    return {Eigen::Quaterniond(Eigen::Map<const Eigen::Vector4d>(block)).normalized(),
            Eigen::Map<const Eigen::Vector3d>(block + 4)};
}

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

bool evaluate_reprojection(CameraModel model, const Eigen::Vector2d& observed_px,
                           double inverse_sigma, const double* const* parameters, double* residuals,
                           double** jacobians) {
    const Eigen::Map<const Eigen::Quaterniond> rotation(parameters[0]);
    const Eigen::Map<const Eigen::Vector3d> translation(parameters[0] + 4);
    const Eigen::Map<const Eigen::Vector3d> point(parameters[1]);
    const Eigen::Vector3d rotated = rotation * point;
    const Eigen::Vector3d in_cam = rotated + translation;
    if (in_cam.z() < 1e-9) return false;
    const double inverse_depth = 1.0 / in_cam.z();
    const Eigen::Vector2d x = in_cam.head<2>() * inverse_depth;
    const PixelDerivatives derivatives = evaluate_camera(model, parameters[2], x);
    Eigen::Map<Eigen::Vector2d>{residuals} = inverse_sigma * (derivatives.pixel - observed_px);
    if (jacobians == nullptr) return true;

    RowMatrix23 x_by_cam;
    x_by_cam << inverse_depth, 0, -x.x() * inverse_depth, 0, inverse_depth, -x.y() * inverse_depth;
    const RowMatrix23 by_cam = inverse_sigma * derivatives.by_normalized * x_by_cam;
    if (jacobians[0] != nullptr) {
        Eigen::Map<RowMatrix27> jacobian(jacobians[0]);
        jacobian.leftCols<3>() = -by_cam * skew(rotated);
        jacobian.middleCols<3>(3) = by_cam;
        jacobian.col(6).setZero();
    }
    if (jacobians[1] != nullptr) {
        Eigen::Map<RowMatrix23>{jacobians[1]} = by_cam * rotation.toRotationMatrix();
    }
    if (jacobians[2] != nullptr) {
        Eigen::Map<RowMatrix28>{jacobians[2]} = inverse_sigma * derivatives.by_intrinsics;
    }
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
