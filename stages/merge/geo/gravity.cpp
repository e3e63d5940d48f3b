// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/merge/geo/gravity.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "stages/algorithms/math/angles.h"
#include "stages/algorithms/math/cauchy.h"
#include "stages/algorithms/math/decompositions.h"

namespace psfm {
namespace {

struct Axes {
    Eigen::Vector3d up;
    Eigen::Vector3d right;
    Eigen::Vector3d forward;
};

/// Sum of the axes' outer products, weighed by how well they agree with `up`.
Eigen::Matrix3d scatter(std::span<const Axes> cameras, const Eigen::Vector3d& up, double roll_sigma,
                        double pitch_sigma) {
    Eigen::Matrix3d level = Eigen::Matrix3d::Zero();
    Eigen::Matrix3d optical = Eigen::Matrix3d::Zero();
    for (const Axes& axes : cameras) {
        const double roll = axes.right.dot(up) / roll_sigma;
        const double pitch = axes.forward.dot(up) / pitch_sigma;
        level += axes.right * axes.right.transpose() / (1.0 + squared(roll / kCauchyScale));
        optical += axes.forward * axes.forward.transpose() / (1.0 + squared(pitch / kCauchyScale));
    }
    return level / squared(roll_sigma) +
           optical / (squared(pitch_sigma) * static_cast<double>(cameras.size()));
}

}  // namespace

Eigen::Vector3d up_in_camera(std::uint8_t orientation) {
    switch (orientation) {
        case 3:
        case 4:
            return Eigen::Vector3d::UnitY();  // row 0 is at the bottom
        case 5:
        case 6:
            return -Eigen::Vector3d::UnitX();  // column 0 is at the top
        case 7:
        case 8:
            return Eigen::Vector3d::UnitX();  // column 0 is at the bottom
        default:
            return -Eigen::Vector3d::UnitY();  // row 0 is at the top
    }
}

std::optional<Gravity> estimate_gravity(std::span<const OrientedCamera> cameras,
                                        const GravityOptions& options) {
    if (cameras.empty()) return std::nullopt;
    std::vector<Axes> all;
    all.reserve(cameras.size());
    Eigen::Vector3d mean_up = Eigen::Vector3d::Zero();
    for (const OrientedCamera& camera : cameras) {
        const Eigen::Quaterniond frame_from_cam = camera.cam_from_frame.conjugate();
        const Eigen::Vector3d up = up_in_camera(camera.orientation);
        Axes axes;
        axes.up = frame_from_cam * up;
        axes.forward = frame_from_cam * Eigen::Vector3d::UnitZ();
        axes.right = axes.forward.cross(axes.up);
        mean_up += axes.up / static_cast<double>(cameras.size());
        all.push_back(axes);
    }
    const double roll_sigma = options.roll_sigma_deg * kRadiansPerDegree;
    const double pitch_sigma = options.pitch_sigma_deg * kRadiansPerDegree;
    Eigensystem<3> eigen;
    // From wide to narrow, so that the start decides nothing but the sign.
    Eigen::Vector3d up = mean_up.norm() > 0.0 ? mean_up.normalized() : all.front().up;
    // Guard: ends the loop; at its own width the scatter settles.
    constexpr std::array<double, 9> kWiden{16.0, 8.0, 4.0, 2.0, 1.0, 1.0, 1.0, 1.0, 1.0};
    for (const double widen : kWiden) {
        eigen = eigensystem(scatter(all, up, roll_sigma * widen, pitch_sigma * widen));
        const Eigen::Vector3d found = eigen.vectors.col(0);
        up = found.dot(up) < 0.0 ? Eigen::Vector3d(-found) : found;
    }
    Gravity gravity;
    const double sign = up.dot(mean_up);
    gravity.up = sign < 0.0 ? Eigen::Vector3d(-up) : up;
    gravity.sign_known = std::abs(sign) >= options.min_mean_up;
    // What is common to all cameras (a habit, the lens) does not average out.
    const double most = 1.0 / squared(options.min_sigma_deg * kRadiansPerDegree);
    gravity.information.setZero();
    for (const int axis : {1, 2}) {
        const Eigen::Vector3d direction = eigen.vectors.col(axis);
        gravity.information +=
            std::min(eigen.values[axis], most) * direction * direction.transpose();
    }
    return gravity;
}

}  // namespace psfm
