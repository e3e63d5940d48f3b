// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/pose/triangulation.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "stages/algorithms/math/decompositions.h"

namespace psfm {

std::optional<Eigen::Vector3d> triangulate(std::span<const View> views) {
    Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
    for (const View& view : views) {
        Eigen::Matrix<double, 3, 4> p;
        p.leftCols<3>() = view.cam_from_world.rotation.toRotationMatrix();
        p.col(3) = view.cam_from_world.translation;
        const Eigen::Vector3d ray = view.normalized.homogeneous().normalized();
        // Rows of the projection onto the plane across the ray: equal weight for every direction of
        // view.
        const Eigen::Matrix<double, 3, 4> across = p - ray * (ray.transpose() * p);
        normal.noalias() += across.transpose() * across;
    }
    const Eigen::Vector4d homogeneous = eigensystem(normal).vectors.col(0);
    constexpr double kAtInfinity = 1e-12;  // Guard: nothing is divided by less
    if (std::abs(homogeneous.w()) < kAtInfinity * homogeneous.head<3>().norm()) return std::nullopt;
    const Eigen::Vector3d point = homogeneous.hnormalized();
    for (const View& view : views) {
        if ((view.cam_from_world * point).z() <= 0.0) return std::nullopt;
    }
    return point;
}

double triangulation_angle(const Eigen::Vector3d& centre1, const Eigen::Vector3d& centre2,
                           const Eigen::Vector3d& point) {
    const Eigen::Vector3d ray1 = centre1 - point;
    const Eigen::Vector3d ray2 = centre2 - point;
    const double angle = std::atan2(ray1.cross(ray2).norm(), ray1.dot(ray2));
    // Rays that point at each other fix the depth as badly as parallel ones.
    return std::min(angle, std::numbers::pi - angle);
}

}  // namespace psfm
