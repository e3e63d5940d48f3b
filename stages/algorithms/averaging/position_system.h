// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/CholmodSupport>
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <cstdint>
#include <span>
#include <vector>

#include "stages/algorithms/averaging/relative_direction.h"

namespace psfm {

/// One column of three coordinates for each node.
using Columns3 = Eigen::Matrix3Xd;

/// Linear systems for positions, one after the other on the same edges: sum over the edges of
/// (x_j - x_i)^T block_e (x_j - x_i), and sum over the nodes of anchor_k |x_k|^2. Factored by
/// CHOLMOD's simplicial method: no BLAS inside, hence the same bits for any number of its threads.
/// Not thread-safe; keeps a reference to the edges.
class PositionSystem {
  public:
    PositionSystem(const std::vector<RelativeDirection>& edges, std::uint32_t node_count);

    /// @param blocks  by edge, symmetric, positive semi-definite
    /// @param anchors by node; large enough in all to make the matrix positive definite
    /// @return whether the matrix could be factored
    bool factor(std::span<const Eigen::Matrix3d> blocks, const Eigen::VectorXd& anchors);

    /// REQUIRES: factored
    Columns3 solve(const Columns3& right_side) const;

  private:
    const std::vector<RelativeDirection>& edges_;
    Eigen::Index size_;
    Eigen::CholmodSimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> factor_;
    std::vector<Eigen::Triplet<double>> entries_;
    bool analysed_ = false;
};

}  // namespace psfm
