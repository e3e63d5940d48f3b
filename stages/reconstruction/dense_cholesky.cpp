// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/dense_cholesky.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <Eigen/Cholesky>
#include <algorithm>

namespace psfm {
namespace {

constexpr Eigen::Index kPanel = 128;  // columns that are factorised at once
constexpr Eigen::Index kTile = 256;   // rows and columns of an update that is one task

}  // namespace

bool factorize_cholesky(Eigen::MatrixXd& matrix) {
    const Eigen::Index size = matrix.rows();
    for (Eigen::Index first = 0; first < size; first += kPanel) {
        const Eigen::Index width = std::min(kPanel, size - first);
        auto corner = matrix.block(first, first, width, width);
        Eigen::Ref<Eigen::MatrixXd> in_place(corner);
        const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(in_place);
        if (factor.info() != Eigen::Success) return false;
        const Eigen::Index next = first + width;
        const Eigen::Index tiles = (size - next + kTile - 1) / kTile;
        const auto rows_of = [&](Eigen::Index tile) {
            const Eigen::Index row = next + tile * kTile;
            return matrix.block(row, first, std::min(kTile, size - row), width);
        };
        // A waiting thread must not begin another solve in the middle of this one.
        tbb::this_task_arena::isolate([&] {
            tbb::parallel_for(Eigen::Index{0}, tiles, [&](Eigen::Index tile) {
                auto rows = rows_of(tile);
                corner.triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(
                    rows);
            });
            tbb::parallel_for(Eigen::Index{0}, tiles * tiles, [&](Eigen::Index pair) {
                const Eigen::Index low = pair / tiles;
                const Eigen::Index left = pair % tiles;
                if (left > low) return;
                const auto a = rows_of(low);
                const auto b = rows_of(left);
                auto target =
                    matrix.block(next + low * kTile, next + left * kTile, a.rows(), b.rows());
                if (low == left) {
                    target.triangularView<Eigen::Lower>() -= a * b.transpose();
                } else {
                    target.noalias() -= a * b.transpose();
                }
            });
        });
    }
    return true;
}

void solve_cholesky(const Eigen::MatrixXd& factor, Eigen::VectorXd& right_side) {
    factor.triangularView<Eigen::Lower>().solveInPlace(right_side);
    factor.triangularView<Eigen::Lower>().transpose().solveInPlace(right_side);
}

}  // namespace psfm
