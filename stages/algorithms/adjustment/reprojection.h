// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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

/// Derivatives of a residual. Rows are stored one after the other, since what is made of them is
/// products of their transposes.
struct ReprojectionDerivatives {
    Eigen::Matrix<double, 2, 6, Eigen::RowMajor> by_pose;  ///< by PoseManifold's tangent
    Eigen::Matrix<double, 2, 3, Eigen::RowMajor> by_point;
    Eigen::Matrix<double, 2, kIntrinsicsSize, Eigen::RowMajor> by_intrinsics;
};

/// A camera in its place, as blocks of parameters say, for many observations.
struct PosedCamera {
    PosedCamera() = default;
    PosedCamera(CameraModel model, const double* pose, const double* intrinsics);

    int focals = 1, distortions = 0;  ///< how many parameters it has of each
    Eigen::Matrix3d rotation;
    Eigen::Vector3d translation;
    /// The lens, whichever the model: what that does not have is zero.
    Eigen::Vector2d focal, centre;
    double k1 = 0.0, k2 = 0.0, p1 = 0.0, p2 = 0.0;
};

/// A point as a camera shows it. Two steps, since what derivatives are multiplied by depends on the
/// residual.
class Reprojection {
  public:
    Reprojection(const PosedCamera& camera, const Eigen::Vector3d& point)
        : camera_(camera),
          rotated_(camera.rotation * point),
          depth_(rotated_.z() + camera.translation.z()) {
        if (!in_front()) return;
        x_ = (rotated_.head<2>() + camera.translation.head<2>()) / depth_;
        r2_ = x_.squaredNorm();
        factor_ = 1.0 + (camera.k1 + camera.k2 * r2_) * r2_;
        bent_ = factor_ * x_ + camera.p1 * tangential1() + camera.p2 * tangential2();
    }

    /// Where it is not, nothing else can be asked.
    bool in_front() const {
        constexpr double kLeastDepth = 1e-9;  // Guard: nothing is divided by less
        return depth_ >= kLeastDepth;
    }
    Eigen::Vector2d pixel() const { return camera_.focal.cwiseProduct(bent_) + camera_.centre; }
    /// Of `scale` times the pixel.
    Eigen::Matrix<double, 2, 3, Eigen::RowMajor> by_point(double scale) const {
        return by_point_in_cam(scale) * camera_.rotation;
    }
    void derivatives(double scale, ReprojectionDerivatives& out) const;

  private:
    Eigen::Vector2d tangential1() const {
        return {2.0 * x_.x() * x_.y(), r2_ + 2.0 * x_.y() * x_.y()};
    }
    Eigen::Vector2d tangential2() const {
        return {r2_ + 2.0 * x_.x() * x_.x(), 2.0 * x_.x() * x_.y()};
    }
    /// By the point in the camera's axes.
    Eigen::Matrix<double, 2, 3, Eigen::RowMajor> by_point_in_cam(double scale) const {
        const PosedCamera& c = camera_;
        const double slope = 2.0 * c.k1 + 4.0 * c.k2 * r2_;
        const double mixed = slope * x_.x() * x_.y() + 2.0 * c.p1 * x_.x() + 2.0 * c.p2 * x_.y();
        const double by_x =
            factor_ + slope * x_.x() * x_.x() + 2.0 * c.p1 * x_.y() + 6.0 * c.p2 * x_.x();
        const double by_y =
            factor_ + slope * x_.y() * x_.y() + 6.0 * c.p1 * x_.y() + 2.0 * c.p2 * x_.x();
        const Eigen::Vector2d f = (scale / depth_) * c.focal;
        Eigen::Matrix<double, 2, 3, Eigen::RowMajor> by;
        by << f.x() * by_x, f.x() * mixed, -f.x() * (by_x * x_.x() + mixed * x_.y()), f.y() * mixed,
            f.y() * by_y, -f.y() * (mixed * x_.x() + by_y * x_.y());
        return by;
    }

    const PosedCamera& camera_;
    Eigen::Vector3d rotated_;  // the point, turned into the camera's axes
    double depth_;
    Eigen::Vector2d x_;  // normalised (z = 1)
    double r2_ = 0.0, factor_ = 1.0;
    Eigen::Vector2d bent_;  // by the lens
};

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

}  // namespace psfm
