// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/merge/geo/fit_to_positions.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "stages/algorithms/math/cauchy.h"
#include "stages/algorithms/math/decompositions.h"

namespace psfm {
namespace {

using Matrix7 = Eigen::Matrix<double, 7, 7>;
using Vector7 = Eigen::Matrix<double, 7, 1>;
using Matrix37 = Eigen::Matrix<double, 3, 7>;

/// Guard: standard deviation of the mean height [m] when no altitude is known: it has to be
/// somewhere.
constexpr double kUnknownHeight = 10.0;
constexpr int kMaxSteps = 50;  // Guard: ends the loop

double cauchy_cost(double squared_residual) {
    return squared(kCauchyScale) * std::log1p(squared_residual / squared(kCauchyScale));
}

double cauchy_weight(double squared_residual) {
    return 1.0 / (1.0 + squared_residual / squared(kCauchyScale));
}

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
    Eigen::Matrix3d m;
    m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
    return m;
}

Eigen::Vector3d mean_centre(std::span<const LocatedCamera> cameras) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const LocatedCamera& camera : cameras) sum += camera.centre;
    return sum / static_cast<double>(cameras.size());
}

bool knows_altitude(std::span<const LocatedCamera> cameras) {
    return std::ranges::any_of(cameras, &LocatedCamera::has_altitude);
}

struct Residual {
    Eigen::Vector3d difference;  ///< where the camera stands - where its file says
    double horizontal = 0.0;     ///< squared, in standard deviations
    double vertical = 0.0;
};

Residual residual_of(const LocatedCamera& camera, const Sim3& sim,
                     const GeoreferenceOptions& options) {
    Residual residual;
    residual.difference = sim * camera.centre - camera.enu;
    residual.horizontal =
        residual.difference.head<2>().squaredNorm() / squared(options.horizontal_sigma_m);
    if (camera.has_altitude)
        residual.vertical = squared(residual.difference.z() / options.vertical_sigma_m);
    return residual;
}

/// Normal equations in (turn about the mean, log scale, shift).
struct Normal {
    Matrix7 matrix = Matrix7::Zero();
    Vector7 gradient = Vector7::Zero();

    void add(const Matrix37& jacobian, const Eigen::Vector3d& residual,
             const Eigen::Vector3d& weights) {
        matrix += jacobian.transpose() * weights.asDiagonal() * jacobian;
        gradient += jacobian.transpose() * weights.cwiseProduct(residual);
    }
};

Normal linearize(std::span<const LocatedCamera> cameras, const Gravity* gravity, const Sim3& sim,
                 const Eigen::Vector3d& mean, const GeoreferenceOptions& options) {
    Normal normal;
    const Eigen::Vector3d mean_in_enu = sim * mean;
    for (const LocatedCamera& camera : cameras) {
        const Residual residual = residual_of(camera, sim, options);
        const Eigen::Vector3d arm = sim * camera.centre - mean_in_enu;
        Matrix37 jacobian;
        jacobian << -cross_matrix(arm), arm, Eigen::Matrix3d::Identity();
        const double horizontal =
            cauchy_weight(residual.horizontal) / squared(options.horizontal_sigma_m);
        const double vertical = camera.has_altitude ? cauchy_weight(residual.vertical) /
                                                          squared(options.vertical_sigma_m)
                                                    : 0.0;
        normal.add(jacobian, residual.difference, {horizontal, horizontal, vertical});
    }
    if (!knows_altitude(cameras)) {
        Matrix37 jacobian = Matrix37::Zero();
        jacobian(2, 6) = 1.0;
        normal.add(jacobian, mean_in_enu, {0.0, 0.0, 1.0 / squared(kUnknownHeight)});
    }
    if (gravity != nullptr) {
        const Eigen::Matrix3d component_from_enu = sim.rotation.conjugate().toRotationMatrix();
        const Eigen::Vector3d up = component_from_enu * Eigen::Vector3d::UnitZ();
        Matrix37 jacobian = Matrix37::Zero();
        jacobian.leftCols<3>() = component_from_enu * cross_matrix(Eigen::Vector3d::UnitZ());
        normal.matrix += jacobian.transpose() * gravity->information * jacobian;
        normal.gradient += jacobian.transpose() * gravity->information * up;
    }
    return normal;
}

Sim3 moved(const Sim3& sim, const Eigen::Vector3d& mean, const Vector7& step) {
    const Eigen::Vector3d turn = step.head<3>();
    const double angle = turn.norm();
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
    if (angle > 0.0) rotation = Eigen::AngleAxisd(angle, turn / angle);
    Sim3 result;
    result.scale = sim.scale * std::exp(step[3]);
    result.rotation = (rotation * sim.rotation).normalized();
    const Eigen::Vector3d mean_in_enu = sim * mean + step.tail<3>();
    result.translation = mean_in_enu - result.scale * (result.rotation * mean);
    return result;
}

}  // namespace

double position_cost(std::span<const LocatedCamera> cameras, const Gravity* gravity,
                     const Sim3& enu_from_component, const GeoreferenceOptions& options) {
    double cost = 0.0;
    for (const LocatedCamera& camera : cameras) {
        const Residual residual = residual_of(camera, enu_from_component, options);
        cost += cauchy_cost(residual.horizontal) + cauchy_cost(residual.vertical);
    }
    if (!knows_altitude(cameras))
        cost += squared((enu_from_component * mean_centre(cameras)).z() / kUnknownHeight);
    if (gravity != nullptr) {
        const Eigen::Vector3d up =
            enu_from_component.rotation.conjugate() * Eigen::Vector3d::UnitZ();
        cost += up.dot(gravity->information * up);
    }
    return cost;
}

Sim3 fit_to_positions(std::span<const LocatedCamera> cameras, const Gravity* gravity,
                      const Sim3& start, const GeoreferenceOptions& options) {
    constexpr double kLargestStep = 1.0;  // Guard: [rad], and log scale
    constexpr double kConverged = 1e-10;  // Guard: relative decrease of the cost
    constexpr double kMostDamping = 1e8;  // Guard: ends the loop: steps of no length
    constexpr double kLeastDamping =
        1e-12;                       // Guard: keeps a step that went wrong from costing many
    constexpr double kFloor = 1e-6;  // Guard: keeps a turn where it is that nothing determines
    const Eigen::Vector3d mean = mean_centre(cameras);
    Sim3 sim = start;
    double cost = position_cost(cameras, gravity, sim, options);
    double damping = 1e-6;
    for (int step = 0; step < kMaxSteps; ++step) {
        const Normal normal = linearize(cameras, gravity, sim, mean, options);
        Matrix7 damped = normal.matrix;
        damped.diagonal() += damping * (normal.matrix.diagonal() + Vector7::Constant(kFloor));
        const Vector7 change = -solve_symmetric(damped, normal.gradient);
        if (!change.allFinite()) break;
        const Sim3 next = moved(sim, mean, change);
        const double next_cost = position_cost(cameras, gravity, next, options);
        if (next_cost < cost && change.head<4>().norm() < kLargestStep) {
            const bool converged = cost - next_cost <= kConverged * cost;
            sim = next;
            cost = next_cost;
            damping = std::max(damping * 0.1, kLeastDamping);
            if (converged) break;
        } else {
            damping *= 10.0;
            if (damping > kMostDamping) break;
        }
    }
    return sim;
}

}  // namespace psfm
