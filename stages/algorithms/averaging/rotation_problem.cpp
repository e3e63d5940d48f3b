// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/averaging/rotation_problem.h"

#include <algorithm>
#include <cmath>

namespace psfm {
namespace {

/// Guard: turns [rad] below which sine over angle is what it is at 0, to the last digit.
constexpr double kNoTurn = 1e-12;

}  // namespace

Eigen::Vector3d rotation_vector(const Eigen::Quaterniond& rotation) {
    const double sine = rotation.vec().norm();
    const double sign = rotation.w() < 0.0 ? -1.0 : 1.0;
    if (sine < kNoTurn) return 2.0 * sign * rotation.vec();
    return sign * 2.0 * std::atan2(sine, std::abs(rotation.w())) / sine * rotation.vec();
}

Eigen::Quaterniond rotation_from_vector(const Eigen::Vector3d& vector) {
    const double angle = vector.norm();
    Eigen::Quaterniond rotation;
    rotation.w() = std::cos(0.5 * angle);
    rotation.vec() = (angle < kNoTurn ? 0.5 : std::sin(0.5 * angle) / angle) * vector;
    return rotation.normalized();
}

Rows3 relative_errors(const RotationProblem& problem) {
    Rows3 errors(static_cast<Eigen::Index>(problem.edges.size()), 3);
    for (std::size_t e = 0; e < problem.edges.size(); ++e) {
        const RotationProblem::Edge& edge = problem.edges[e];
        const Eigen::Quaterniond left = problem.node_from_reference[edge.j].conjugate() *
                                        edge.j_from_i * problem.node_from_reference[edge.i];
        errors.row(static_cast<Eigen::Index>(e)) = rotation_vector(left).transpose();
    }
    return errors;
}

void apply_step(RotationProblem& problem, const Rows3& steps, double fraction) {
    for (std::size_t k = 1; k < problem.node_from_reference.size(); ++k) {
        const Eigen::Vector3d step = fraction * steps.row(static_cast<Eigen::Index>(k)).transpose();
        Eigen::Quaterniond& rotation = problem.node_from_reference[k];
        rotation = (rotation * rotation_from_vector(step)).normalized();
    }
}

Rows3 sums_at_nodes(const RotationProblem& problem, const Rows3& by_edge) {
    Rows3 sums = Rows3::Zero(static_cast<Eigen::Index>(problem.node_from_reference.size()), 3);
    for (std::size_t e = 0; e < problem.edges.size(); ++e) {
        sums.row(problem.edges[e].j) += by_edge.row(static_cast<Eigen::Index>(e));
        sums.row(problem.edges[e].i) -= by_edge.row(static_cast<Eigen::Index>(e));
    }
    return sums;
}

Eigen::SparseMatrix<double> reduced_laplacian(const RotationProblem& problem,
                                              const Eigen::VectorXd& weights) {
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(3 * problem.edges.size());
    for (std::size_t e = 0; e < problem.edges.size(); ++e) {
        const double weight = weights[static_cast<Eigen::Index>(e)];
        const int i = static_cast<int>(problem.edges[e].i) - 1;
        const int j = static_cast<int>(problem.edges[e].j) - 1;
        if (i >= 0) entries.emplace_back(i, i, weight);
        if (j >= 0) entries.emplace_back(j, j, weight);
        if (i >= 0 && j >= 0) entries.emplace_back(std::max(i, j), std::min(i, j), -weight);
    }
    const auto size = static_cast<Eigen::Index>(problem.node_from_reference.size()) - 1;
    Eigen::SparseMatrix<double> laplacian(size, size);
    laplacian.setFromTriplets(entries.begin(), entries.end());
    return laplacian;
}

}  // namespace psfm
