// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/alignment/refine_sim3.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "stages/algorithms/math/decompositions.h"

namespace psfm {
namespace {

/// Turn, shift and logarithm of the scale of b_from_a.
using Step = Eigen::Matrix<double, 7, 1>;
using Square = Eigen::Matrix<double, 7, 7>;

constexpr int kMaxIterations = 50;  // Guard: ends the loop
/// Guard: the last digits of the cost take half of the iterations, and move nothing.
constexpr double kCostTolerance = 1e-9;

/// A view with its rotation as a matrix, since its points are many.
struct FastView {
    Eigen::Matrix3d rotation;
    Eigen::Vector3d translation;
    double focal;

    explicit FastView(const EdgeView& view)
        : rotation(view.cam_from_cluster.rotation.toRotationMatrix()),
          translation(view.cam_from_cluster.translation),
          focal(view.focal) {}

    Eigen::Vector3d in_camera(const Eigen::Vector3d& point) const {
        return rotation * point + translation;
    }
    Eigen::Vector2d projected(const Eigen::Vector3d& in_cam) const {
        return focal * in_cam.head<2>() / in_cam.z();
    }
    /// d projection / d point in the cluster.
    Eigen::Matrix<double, 2, 3> jacobian(const Eigen::Vector3d& in_cam) const {
        const Eigen::Vector2d slope = in_cam.head<2>() / in_cam.z();
        return focal / in_cam.z() * (rotation.topRows<2>() - slope * rotation.row(2).eval());
    }
};

/// A correspondence that takes part, and where each image sees its own point.
struct Term {
    Eigen::Vector3d in_a;
    Eigen::Vector3d in_b;
    Eigen::Vector2d seen_in_a;
    Eigen::Vector2d seen_in_b;
};

struct EdgeTerms {
    FastView a;
    FastView b;
    std::vector<Term> terms;
};

std::vector<EdgeTerms> agreeing_with(std::span<const EdgeCorrespondences> edges,
                                     const Sim3& b_from_a, double max_error) {
    const Sim3 a_from_b = inverse(b_from_a);
    std::vector<EdgeTerms> result;
    for (const EdgeCorrespondences& edge : edges) {
        EdgeTerms own{FastView(edge.view_a), FastView(edge.view_b), {}};
        const CorrespondenceError error(edge, b_from_a, a_from_b);
        for (const PointCorrespondence& point : edge.points) {
            if (error(point) > max_error) continue;
            own.terms.push_back({point.in_a, point.in_b,
                                 own.a.projected(own.a.in_camera(point.in_a)),
                                 own.b.projected(own.b.in_camera(point.in_b))});
        }
        if (!own.terms.empty()) result.push_back(std::move(own));
    }
    return result;
}

/// Half the sum of Huber's losses, and the normal equations of the residuals weighted accordingly.
struct System {
    Square information = Square::Zero();
    Step gradient = Step::Zero();
    double cost = 0.0;
};

/// @return infinite cost when a point comes to lie behind a camera
System linearize(std::span<const EdgeTerms> edges, const Sim3& b_from_a, double loss_scale) {
    const Eigen::Matrix3d turn = b_from_a.rotation.toRotationMatrix();
    const Eigen::Matrix3d turn_back = turn.transpose() / b_from_a.scale;
    System system;
    Eigen::Matrix<double, 4, 7> j;
    Eigen::Vector4d residual;
    for (const EdgeTerms& edge : edges) {
        for (const Term& term : edge.terms) {
            // Either point from a's origin, along b's axes and in b's unit.
            const Eigen::Vector3d from_a = b_from_a.scale * (turn * term.in_a);
            const Eigen::Vector3d from_b = term.in_b - b_from_a.translation;
            const Eigen::Vector3d in_cam_a = edge.a.in_camera(turn_back * from_b);
            const Eigen::Vector3d in_cam_b = edge.b.in_camera(from_a + b_from_a.translation);
            if (!(in_cam_a.z() > 0.0 && in_cam_b.z() > 0.0)) {
                system.cost = std::numeric_limits<double>::infinity();
                return system;
            }
            residual.head<2>() = edge.a.projected(in_cam_a) - term.seen_in_a;
            residual.tail<2>() = edge.b.projected(in_cam_b) - term.seen_in_b;
            Eigen::Matrix<double, 4, 3> by_shift;
            by_shift.topRows<2>() = -edge.a.jacobian(in_cam_a) * turn_back;
            by_shift.bottomRows<2>() = edge.b.jacobian(in_cam_b);
            for (int row = 0; row < 4; ++row) {
                const Eigen::Vector3d along = by_shift.row(row);
                // Turning or scaling a's frame moves b's points, as seen from it, the other way:
                // the sign is in `along`.
                const Eigen::Vector3d& arm = row < 2 ? from_b : from_a;
                j.row(row).head<3>() = arm.cross(along);
                j.row(row).segment<3>(3) = along;
                j(row, 6) = along.dot(arm);
            }
            const double length = residual.norm();
            const double weight = length > loss_scale ? loss_scale / length : 1.0;
            system.information.noalias() += weight * j.transpose() * j;
            system.gradient.noalias() += weight * j.transpose() * residual;
            system.cost += length > loss_scale ? loss_scale * (length - 0.5 * loss_scale)
                                               : 0.5 * length * length;
        }
    }
    return system;
}

Sim3 moved(const Sim3& b_from_a, const Step& step) {
    const Eigen::Vector3d half = 0.5 * step.head<3>();
    const Eigen::Quaterniond turn(1.0, half.x(), half.y(), half.z());
    return {b_from_a.scale * std::exp(step[6]),
            (turn.normalized() * b_from_a.rotation).normalized(),
            b_from_a.translation + step.segment<3>(3)};
}

}  // namespace

Sim3 refine_sim3(std::span<const EdgeCorrespondences> edges, const Sim3& b_from_a,
                 const ClusterConstraintOptions& options) {
    const double loss_scale = options.loss_part * options.max_error;
    const std::vector<EdgeTerms> terms = agreeing_with(edges, b_from_a, options.max_error);
    std::size_t count = 0;
    for (const EdgeTerms& edge : terms) count += edge.terms.size();
    if (count < 3) return b_from_a;

    Sim3 refined = b_from_a;
    System system = linearize(terms, refined, loss_scale);
    constexpr double kMostDamping = 1e6;    // Guard: ends the loop: steps of no length
    constexpr double kLeastDamping = 1e-9;  // Guard: keeps a step that went wrong from costing many
    double damping = 1e-4;
    for (int iteration = 0; iteration < kMaxIterations && damping < kMostDamping; ++iteration) {
        Square damped = system.information;
        damped.diagonal() *= 1.0 + damping;
        const Step step = -solve_symmetric(damped, system.gradient);
        if (!step.allFinite()) break;
        const Sim3 candidate = moved(refined, step);
        const System next = linearize(terms, candidate, loss_scale);
        if (!(next.cost < system.cost)) {
            damping *= 10.0;
            continue;
        }
        const bool converged = system.cost - next.cost < kCostTolerance * system.cost;
        refined = candidate;
        system = next;
        damping = std::max(0.1 * damping, kLeastDamping);
        if (converged) break;
    }
    return refined;
}

}  // namespace psfm
