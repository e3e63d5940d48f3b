// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/SparseCore>
#include <cstdint>
#include <vector>

namespace psfm {

/// One row of three for each node or edge.
using Rows3 = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// Averaging in one connected component, with nodes numbered from 0. Node 0 is the reference: its
/// rotation is never changed. Invariants: connected; weights positive, their mean 1.
struct RotationProblem {
    struct Edge {
        std::uint32_t i = 0;
        std::uint32_t j = 0;
        Eigen::Quaterniond j_from_i = Eigen::Quaterniond::Identity();
        double weight = 1.0;
    };
    std::vector<Edge> edges;
    std::vector<Eigen::Quaterniond> node_from_reference;
};

/// Rotation vector [rad] of a unit quaternion, length at most pi, and back.
Eigen::Vector3d rotation_vector(const Eigen::Quaterniond& rotation);
Eigen::Quaterniond rotation_from_vector(const Eigen::Vector3d& vector);

/// By edge: the rotation vector, in the reference frame, that is left of the measurement,
/// log(R_j^-1 R_ij R_i). To first order a step w_i, w_j (see apply_step) takes w_j - w_i off it.
Rows3 relative_errors(const RotationProblem& problem);

/// R_k <- R_k exp(fraction * steps.row(k)).
void apply_step(RotationProblem& problem, const Rows3& steps, double fraction);

/// A^T y: by node, the sum over its edges of y.row(edge), negative where the edge starts.
Rows3 sums_at_nodes(const RotationProblem& problem, const Rows3& by_edge);

/// A^T diag(weights) A without the reference's row and column: node k is row k - 1. Lower triangle.
/// Positive definite.
Eigen::SparseMatrix<double> reduced_laplacian(const RotationProblem& problem,
                                              const Eigen::VectorXd& weights);

}  // namespace psfm
