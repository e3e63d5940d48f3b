// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/merge/refine_sim3.h"

#include <ceres/ceres.h>

#include <array>
#include <cmath>
#include <exception>
#include <memory>

namespace psfm {
namespace {

/// Quaternion x y z w, translation, log scale of b_from_a.
using Parameters = std::array<double, 8>;

/// Where a view sees a point [longer image sides].
template <typename T>
Eigen::Matrix<T, 2, 1> projected(const View& view, const Eigen::Matrix<T, 3, 1>& in_cam) {
    return view.focal * in_cam.template head<2>() / in_cam[2];
}

class ProjectionDistance {
  public:
    ProjectionDistance(const EdgeCorrespondences& edge, const PointCorrespondence& point)
        : view_a_(&edge.view_a),
          view_b_(&edge.view_b),
          point_(&point),
          seen_in_a_(projected<double>(edge.view_a, edge.view_a.cam_from_cluster * point.in_a)),
          seen_in_b_(projected<double>(edge.view_b, edge.view_b.cam_from_cluster * point.in_b)) {}

    template <typename T>
    bool operator()(const T* rotation, const T* shift_and_scale, T* residuals) const {
        using Vector3 = Eigen::Matrix<T, 3, 1>;
        const Eigen::Map<const Eigen::Quaternion<T>> b_from_a(rotation);
        const Eigen::Map<const Vector3> translation(shift_and_scale);
        const T scale = exp(shift_and_scale[3]);
        const Vector3 a_in_b = scale * (b_from_a * point_->in_a.cast<T>()) + translation;
        const Vector3 b_in_a =
            b_from_a.conjugate() * (point_->in_b.cast<T>() - translation) / scale;
        return distance(*view_a_, seen_in_a_, b_in_a, residuals) &&
               distance(*view_b_, seen_in_b_, a_in_b, residuals + 2);
    }

  private:
    template <typename T>
    static bool distance(const View& view, const Eigen::Vector2d& seen,
                         const Eigen::Matrix<T, 3, 1>& other, T* residuals) {
        const Rigid3& pose = view.cam_from_cluster;
        const Eigen::Matrix<T, 3, 1> in_cam =
            pose.rotation.cast<T>() * other + pose.translation.cast<T>();
        if (!(in_cam[2] > T(0.0))) return false;
        Eigen::Map<Eigen::Matrix<T, 2, 1>>{residuals} = projected<T>(view, in_cam) - seen.cast<T>();
        return true;
    }

    const View* view_a_;
    const View* view_b_;
    const PointCorrespondence* point_;
    Eigen::Vector2d seen_in_a_;
    Eigen::Vector2d seen_in_b_;
};

}  // namespace

Sim3 refine_sim3(std::span<const EdgeCorrespondences> edges, const Sim3& b_from_a,
                 double max_error) {
    constexpr double kHuberPart = 1.0 / 3.0;
    Parameters parameters{};
    Eigen::Map<Eigen::Quaterniond>(parameters.data()) = b_from_a.rotation;
    Eigen::Map<Eigen::Vector3d>(parameters.data() + 4) = b_from_a.translation;
    parameters[7] = std::log(b_from_a.scale);
    try {
        ceres::Problem::Options owned;
        owned.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
        ceres::HuberLoss loss(kHuberPart * max_error);
        ceres::Problem problem(owned);
        problem.AddParameterBlock(parameters.data(), 4, new ceres::EigenQuaternionManifold);
        problem.AddParameterBlock(parameters.data() + 4, 4);
        const Sim3 a_from_b = inverse(b_from_a);
        for (const EdgeCorrespondences& edge : edges) {
            for (const PointCorrespondence& point : edge.points) {
                if (correspondence_error(edge, point, b_from_a, a_from_b) > max_error) continue;
                auto distance = std::make_unique<ProjectionDistance>(edge, point);
                using Cost = ceres::AutoDiffCostFunction<ProjectionDistance, 4, 4, 4>;
                problem.AddResidualBlock(new Cost(distance.release()), &loss, parameters.data(),
                                         parameters.data() + 4);
            }
        }
        if (problem.NumResidualBlocks() < 3) return b_from_a;
        ceres::Solver::Options options;
        // Seven unknowns, and up to tens of thousands of residuals.
        options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
        options.max_num_iterations = 50;
        // The last digits of the cost take half of the iterations, and move nothing.
        options.function_tolerance = 1e-9;
        options.parameter_tolerance = 1e-12;
        options.gradient_tolerance = 1e-14;
        options.num_threads = 1;
        options.logging_type = ceres::SILENT;
        ceres::Solver::Summary summary;
        ceres::Solve(options, &problem, &summary);
        if (!summary.IsSolutionUsable()) return b_from_a;
    } catch (const std::exception&) {
        return b_from_a;
    }
    Sim3 refined;
    refined.rotation = Eigen::Map<Eigen::Quaterniond>(parameters.data()).normalized();
    refined.translation = Eigen::Map<Eigen::Vector3d>(parameters.data() + 4);
    refined.scale = std::exp(parameters[7]);
    return refined;
}

}  // namespace psfm
