// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/two_view/refine_two_view.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "stages/algorithms/math/decompositions.h"

namespace psfm {
namespace {

Eigen::Quaterniond rotation_by(const Eigen::Vector3d& w) {
    constexpr double kNoAxis = 1e-12;  // Guard: [rad]; nothing is divided by less
    const double angle = w.norm();
    if (angle < kNoAxis)
        return Eigen::Quaterniond(1, 0.5 * w.x(), 0.5 * w.y(), 0.5 * w.z()).normalized();
    return Eigen::Quaterniond(Eigen::AngleAxisd(angle, w / angle));
}

Vector9d stacked(const Eigen::Matrix3d& m) {
    return Eigen::Map<const Vector9d>(m.data());
}

/// f = U diag(1, s, 0) V'.
struct OrthonormalF {
    Eigen::Matrix3d u = Eigen::Matrix3d::Identity();
    Eigen::Matrix3d v = Eigen::Matrix3d::Identity();
    double ratio = 1.0;

    Eigen::Matrix3d matrix() const {
        return u.col(0) * v.col(0).transpose() + ratio * u.col(1) * v.col(1).transpose();
    }
};

/// What the minimiser below asks of a model: its matrix, d vec(matrix) / d parameters, and a step.
struct PoseModel {
    static constexpr int kParameters = 5;  // Mathematics: rotation and direction
    const IntrinsicPair* intrinsics;
    Rigid3 pose;

    Eigen::Matrix3d matrix() const { return fundamental_from_pose(pose, *intrinsics); }
    Eigen::Matrix<double, 9, 5> jacobian() const { return pose_jacobian(pose, *intrinsics); }
    PoseModel moved(const Eigen::Matrix<double, 5, 1>& step) const {
        return {intrinsics, moved_pose(pose, step)};
    }
};

struct FundamentalModel {
    static constexpr int kParameters = 7;  // Mathematics: nine of a matrix, less scale and rank
    OrthonormalF f;

    Eigen::Matrix3d matrix() const { return f.matrix(); }
    Eigen::Matrix<double, 9, 7> jacobian() const {
        const Eigen::Matrix3d m = f.matrix();
        Eigen::Matrix<double, 9, 7> j;
        for (int axis = 0; axis < 3; ++axis) {
            const Eigen::Matrix3d generator = cross_matrix(Eigen::Vector3d::Unit(axis));
            j.col(axis) = stacked(generator * m);
            j.col(3 + axis) = stacked(-m * generator);
        }
        j.col(6) = stacked(f.u.col(1) * f.v.col(1).transpose());
        return j;
    }
    FundamentalModel moved(const Eigen::Matrix<double, 7, 1>& step) const {
        FundamentalModel next;
        next.f.u = rotation_by(step.head<3>()).toRotationMatrix() * f.u;
        next.f.v = rotation_by(step.segment<3>(3)).toRotationMatrix() * f.v;
        next.f.ratio = f.ratio + step[6];
        return next;
    }
};

template <typename Model>
Model minimize(std::span<const PointPair> points, Model model, const RefineOptions& options) {
    using Step = Eigen::Matrix<double, Model::kParameters, 1>;
    using Square = Eigen::Matrix<double, Model::kParameters, Model::kParameters>;
    SampsonSystem system = linearize_sampson(points, model.matrix(), options.loss_scale);
    constexpr double kMostDamping = 1e6;    // Guard: ends the loop: steps of no length
    constexpr double kLeastDamping = 1e-9;  // Guard: keeps a step that went wrong from costing many
    constexpr double kFloor = 1e-12;        // Guard: of the diagonal, in parts of its sum
    double damping = 1e-4;
    for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
        const Eigen::Matrix<double, 9, Model::kParameters> j = model.jacobian();
        Square normal = j.transpose() * system.information * j;
        const Step gradient = j.transpose() * system.gradient;
        normal.diagonal() += damping * normal.diagonal() + Step::Constant(kFloor * normal.trace());
        const Step step = -solve_symmetric(normal, gradient);
        if (!step.allFinite()) break;
        const Model candidate = model.moved(step);
        const SampsonSystem next =
            linearize_sampson(points, candidate.matrix(), options.loss_scale);
        if (!(next.cost < system.cost)) {
            damping *= 10.0;
            if (damping > kMostDamping) break;
            continue;
        }
        const bool converged = system.cost - next.cost < options.cost_tolerance * system.cost;
        model = candidate;
        system = next;
        damping = std::max(0.1 * damping, kLeastDamping);
        if (converged) break;
    }
    return model;
}

}  // namespace

Eigen::Matrix<double, 3, 2> tangent_basis(const Eigen::Vector3d& direction) {
    int smallest = 0;
    direction.cwiseAbs().minCoeff(&smallest);
    Eigen::Matrix<double, 3, 2> basis;
    basis.col(0) = direction.cross(Eigen::Vector3d::Unit(smallest)).normalized();
    basis.col(1) = direction.cross(basis.col(0)).normalized();
    return basis;
}

Eigen::Matrix3d fundamental_from_pose(const Rigid3& cam2_from_cam1,
                                      const IntrinsicPair& intrinsics) {
    return intrinsics.k2.inverse().transpose() * cross_matrix(cam2_from_cam1.translation) *
           cam2_from_cam1.rotation.toRotationMatrix() * intrinsics.k1.inverse();
}

Eigen::Matrix<double, 9, 5> pose_jacobian(const Rigid3& cam2_from_cam1,
                                          const IntrinsicPair& intrinsics) {
    const Eigen::Matrix3d left = intrinsics.k2.inverse().transpose();
    const Eigen::Matrix3d right =
        cam2_from_cam1.rotation.toRotationMatrix() * intrinsics.k1.inverse();
    const Eigen::Matrix3d translation = cross_matrix(cam2_from_cam1.translation);
    const Eigen::Matrix<double, 3, 2> basis = tangent_basis(cam2_from_cam1.translation);
    Eigen::Matrix<double, 9, 5> j;
    for (int axis = 0; axis < 3; ++axis) {
        j.col(axis) =
            stacked(left * translation * cross_matrix(Eigen::Vector3d::Unit(axis)) * right);
    }
    for (int axis = 0; axis < 2; ++axis) {
        j.col(3 + axis) = stacked(left * cross_matrix(basis.col(axis)) * right);
    }
    return j;
}

Rigid3 moved_pose(const Rigid3& cam2_from_cam1, const Eigen::Matrix<double, 5, 1>& step) {
    const Eigen::Matrix<double, 3, 2> basis = tangent_basis(cam2_from_cam1.translation);
    return {(rotation_by(step.head<3>()) * cam2_from_cam1.rotation).normalized(),
            (cam2_from_cam1.translation + basis * step.tail<2>()).normalized()};
}

Rigid3 refine_relative_pose(std::span<const PointPair> points, const IntrinsicPair& intrinsics,
                            const Rigid3& cam2_from_cam1, const RefineOptions& options) {
    return minimize(points, PoseModel{&intrinsics, cam2_from_cam1}, options).pose;
}

Eigen::Matrix3d refine_fundamental(std::span<const PointPair> points, const Eigen::Matrix3d& f,
                                   const RefineOptions& options) {
    const SingularValues svd = singular_values(f);
    FundamentalModel start;
    start.f.u = svd.u;
    start.f.v = svd.v;
    start.f.ratio = svd.values[1] / svd.values[0];
    return minimize(points, start, options).matrix().normalized();
}

}  // namespace psfm
