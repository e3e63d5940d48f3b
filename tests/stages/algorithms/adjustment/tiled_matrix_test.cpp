// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/adjustment/tiled_matrix.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <random>

namespace psfm {
namespace {

/// Blocks of six columns along a path: each depends on the next `reach` ones; the last block
/// on all, as shared intrinsics do.
struct PathMatrix {
    PathMatrix(std::size_t blocks, std::size_t reach)
        : pattern(starts_of(blocks), 6 * blocks),
          dense(Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(6 * blocks),
                                      static_cast<Eigen::Index>(6 * blocks))),
          right(dense.rows()) {
        std::mt19937_64 rng(11);
        std::normal_distribution<double> normal;
        for (double& value : right) value = normal(rng);
        for (std::size_t a = 0; a < blocks; ++a) {
            for (std::size_t b = a; b < blocks; ++b) {
                if (b - a > reach && b + 1 < blocks) continue;
                Eigen::Matrix<double, 6, 6> coupling;
                for (double& value : coupling.reshaped()) value = normal(rng);
                const auto row = static_cast<Eigen::Index>(6 * b);
                const auto column = static_cast<Eigen::Index>(6 * a);
                if (a == b) coupling = (coupling + coupling.transpose()).eval();
                dense.block<6, 6>(row, column) = coupling;
                dense.block<6, 6>(column, row) = coupling.transpose();
                std::vector<std::uint32_t> tiles = {pattern.tile_of(6 * a), pattern.tile_of(6 * b)};
                if (tiles[0] != tiles[1]) pattern.couple(tiles);
            }
        }
        dense.diagonal().array() += 10.0 * static_cast<double>(blocks);
        pattern.fill();
    }

    static std::vector<std::size_t> starts_of(std::size_t blocks) {
        std::vector<std::size_t> starts(blocks);
        for (std::size_t i = 0; i < blocks; ++i) starts[i] = 6 * i;
        return starts;
    }

    TiledMatrix tiled() const {
        TiledMatrix matrix(pattern);
        for (std::size_t row = 0; row < pattern.columns(); ++row) {
            for (std::size_t column = 0; column <= row; ++column) {
                const double value =
                    dense(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column));
                if (value != 0.0) matrix.at(row, column) = value;
            }
        }
        return matrix;
    }

    TilePattern pattern;
    Eigen::MatrixXd dense;
    Eigen::VectorXd right;
};

TEST(TiledMatrix, SolvesLikeEigen) {
    for (const std::size_t blocks : {1U, 31U, 32U, 33U, 65U, 260U}) {
        for (const std::size_t reach : {std::size_t{1}, std::size_t{20}, blocks}) {
            const PathMatrix problem(blocks, reach);
            TiledMatrix matrix = problem.tiled();
            ASSERT_TRUE(matrix.factorize());
            Eigen::VectorXd solution = problem.right;
            matrix.solve(solution);
            const Eigen::VectorXd expected = problem.dense.llt().solve(problem.right);
            EXPECT_LT((solution - expected).norm(), 1e-10 * expected.norm())
                << blocks << " blocks, reach " << reach;
        }
    }
}

TEST(TiledMatrix, WhatIsEmptyTakesNoMemory) {
    const PathMatrix chain(500, 1);
    const PathMatrix full(500, 500);
    EXPECT_EQ(chain.pattern.columns(), 3000U);
    EXPECT_LT(5 * chain.pattern.bytes(), 2 * full.pattern.bytes());
    EXPECT_GT(2 * full.pattern.bytes(), 3000U * 3000U * sizeof(double));
}

TEST(TiledMatrix, AFactorisationFillsWhatItNeeds) {
    // An arrow that points the wrong way: eliminating its head couples everything.
    TilePattern pattern(PathMatrix::starts_of(200), 1200);
    const std::uint32_t last = pattern.tiles() - 1;
    for (std::uint32_t tile = 1; tile <= last; ++tile)
        pattern.couple(std::vector<std::uint32_t>{0, tile});
    EXPECT_FALSE(pattern.has(last, 1));
    pattern.fill();
    for (std::uint32_t row = 0; row <= last; ++row) {
        for (std::uint32_t column = 0; column <= row; ++column)
            EXPECT_TRUE(pattern.has(row, column));
    }
}

TEST(TiledMatrix, HasRoomForWhatItsFactorisationFills) {
    constexpr Eigen::Index kSize = 1200;
    TilePattern pattern(PathMatrix::starts_of(200), kSize);
    for (std::uint32_t tile = 1; tile < pattern.tiles(); ++tile)
        pattern.couple(std::vector<std::uint32_t>{0, tile});
    TiledMatrix matrix(pattern);
    Eigen::MatrixXd dense = Eigen::MatrixXd::Identity(kSize, kSize) * 2000.0;
    dense.col(0).setOnes();
    dense.row(0).setOnes();
    dense(0, 0) = 2000.0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(kSize); ++i) {
        matrix.at(i, 0) = 1.0;
        matrix.at(i, i) = 2000.0;
    }
    ASSERT_TRUE(matrix.factorize());
    Eigen::VectorXd solution = Eigen::VectorXd::LinSpaced(kSize, 1.0, 2.0);
    const Eigen::VectorXd expected = dense.llt().solve(solution);
    matrix.solve(solution);
    EXPECT_LT((solution - expected).norm(), 1e-12 * expected.norm());
}

TEST(TiledMatrix, TilesCutNoBlock) {
    // Poses of six columns, then intrinsics of three.
    std::vector<std::size_t> starts = PathMatrix::starts_of(100);
    for (std::size_t camera = 0; camera < 100; ++camera) starts.push_back(600 + 3 * camera);
    const TilePattern pattern(starts, 900);
    EXPECT_GE(pattern.tiles(), 5U);
    for (std::size_t block = 0; block < starts.size(); ++block) {
        const std::size_t end = block + 1 < starts.size() ? starts[block + 1] : 900;
        EXPECT_EQ(pattern.tile_of(starts[block]), pattern.tile_of(end - 1)) << block;
    }
    EXPECT_EQ(pattern.first_of(pattern.tiles()), 900U);
}

TEST(TiledMatrix, IsBitwiseTheSameOnAnyNumberOfThreads) {
    const PathMatrix problem(300, 50);
    Eigen::VectorXd first;
    for (const std::size_t threads : {1U, 2U, 5U}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        TiledMatrix matrix = problem.tiled();
        ASSERT_TRUE(matrix.factorize());
        Eigen::VectorXd solution = problem.right;
        matrix.solve(solution);
        if (threads == 1) first = solution;
        EXPECT_EQ(solution, first) << threads;
    }
}

TEST(TiledMatrix, RefusesWhatIsNotPositiveDefinite) {
    for (const std::size_t blocks : {1U, 80U}) {
        const PathMatrix problem(blocks, 2);
        TiledMatrix matrix = problem.tiled();
        matrix.at(6 * blocks - 1, 6 * blocks - 1) = -1.0;
        EXPECT_FALSE(matrix.factorize()) << blocks;
        matrix.set_zero();
        EXPECT_FALSE(matrix.factorize()) << blocks;
    }
}

}  // namespace
}  // namespace psfm
