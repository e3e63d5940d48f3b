// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/averaging/position_system.h"

#include <algorithm>

namespace psfm {
namespace {

void add_block(std::vector<Eigen::Triplet<double>>& entries, std::uint32_t row_node,
               std::uint32_t column_node, const Eigen::Matrix3d& block) {
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) {
            // Off the diagonal the whole block lies in the lower triangle.
            if (row_node == column_node && column > row) continue;
            entries.emplace_back(3 * static_cast<int>(row_node) + row,
                                 3 * static_cast<int>(column_node) + column, block(row, column));
        }
    }
}

}  // namespace

PositionSystem::PositionSystem(const std::vector<RelativeDirection>& edges,
                               std::uint32_t node_count)
    : edges_(edges), size_(3 * static_cast<Eigen::Index>(node_count)) {
    factor_.cholmod().print = 0;  // errors are returned, not printed
    entries_.reserve(21 * edges.size() + static_cast<std::size_t>(size_));
}

bool PositionSystem::factor(std::span<const Eigen::Matrix3d> blocks,
                            const Eigen::VectorXd& anchors) {
    entries_.clear();
    for (std::size_t e = 0; e < edges_.size(); ++e) {
        const auto [low, high] = std::minmax(edges_[e].i, edges_[e].j);
        add_block(entries_, low, low, blocks[e]);
        add_block(entries_, high, high, blocks[e]);
        add_block(entries_, high, low, -blocks[e]);
    }
    for (int k = 0; k < static_cast<int>(size_); ++k) entries_.emplace_back(k, k, anchors[k / 3]);
    Eigen::SparseMatrix<double> matrix(size_, size_);
    matrix.setFromTriplets(entries_.begin(), entries_.end());
    if (!analysed_) factor_.analyzePattern(matrix);
    analysed_ = true;
    factor_.factorize(matrix);
    return factor_.info() == Eigen::Success;
}

Columns3 PositionSystem::solve(const Columns3& right_side) const {
    const Eigen::VectorXd stacked = Eigen::Map<const Eigen::VectorXd>(right_side.data(), size_);
    const Eigen::VectorXd solved = factor_.solve(stacked);
    return Eigen::Map<const Columns3>(solved.data(), 3, size_ / 3);
}

}  // namespace psfm
