// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/localisation/pose_covariance.h"

#include <Eigen/Geometry>

#include "stages/algorithms/math/decompositions.h"

namespace psfm {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// The pose a step away.
Rigid3 moved(const Rigid3& cam_from_world, int axis, double step) {
    Rigid3 result = cam_from_world;
    if (axis < 3) {
        const Eigen::AngleAxisd turn(step, Eigen::Vector3d::Unit(axis));
        const Eigen::Vector3d centre = cam_from_world.target_origin_in_source();
        result.rotation = (Eigen::Quaterniond(turn) * cam_from_world.rotation).normalized();
        result.translation = result.rotation * -centre;
    } else {
        result.translation -= result.rotation * (step * Eigen::Vector3d::Unit(axis - 3));
    }
    return result;
}

}  // namespace

std::optional<Matrix6> pose_covariance(std::span<const Eigen::Vector2d> pixels,
                                       std::span<const Eigen::Vector3d> points,
                                       const Camera& camera, const Rigid3& cam_from_world) {
    Matrix6 information = Matrix6::Zero();
    double squares = 0.0;
    std::size_t count = 0;
    double distance = 0.0;
    for (const Eigen::Vector3d& point : points) distance += (cam_from_world * point).norm();
    if (points.empty()) return std::nullopt;
    distance /= static_cast<double>(points.size());
    constexpr double kStep = 1e-6;  // Mathematics: of central differences [rad; mean distances]
    for (std::size_t i = 0; i < points.size(); ++i) {
        const auto seen = project(camera, cam_from_world * points[i]);
        if (!seen) continue;
        Eigen::Matrix<double, 2, 6> jacobian;
        bool whole = true;
        for (int axis = 0; axis < 6; ++axis) {
            const double step = axis < 3 ? kStep : kStep * distance;
            const auto after = project(camera, moved(cam_from_world, axis, step) * points[i]);
            const auto before = project(camera, moved(cam_from_world, axis, -step) * points[i]);
            whole = whole && after && before;
            if (whole) jacobian.col(axis) = (*after - *before) / (2.0 * step);
        }
        if (!whole) continue;
        information += jacobian.transpose() * jacobian;
        squares += (*seen - pixels[i]).squaredNorm();
        ++count;
    }
    if (count < 4) return std::nullopt;
    // Axes of different units: made alike for the inverse, and back again.
    Matrix6 scale = Matrix6::Identity();
    for (int axis = 3; axis < 6; ++axis) scale(axis, axis) = distance;
    const Matrix6 scaled = scale * information * scale;
    const Matrix6 inverse = solve_symmetric(scaled, Matrix6::Identity());
    // The traces' product is the condition number, or up to 36 times that.
    const bool is_determined =
        inverse.diagonal().minCoeff() > 0.0 && scaled.trace() * inverse.trace() < 1e12;
    if (!is_determined) return std::nullopt;
    const double variance = squares / (2.0 * static_cast<double>(count) - 6.0);
    return Matrix6(variance * scale * inverse * scale);
}

}  // namespace psfm
