// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/math/decompositions.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/synthetic/rng.h"

namespace psfm {
namespace {

Eigen::MatrixXd random_matrix(Eigen::Index rows, Eigen::Index columns, std::uint64_t seed) {
    synthetic::Rng rng(seed);
    Eigen::MatrixXd matrix(rows, columns);
    for (double& value : matrix.reshaped()) value = rng.uniform(-1.0, 1.0);
    return matrix;
}

/// Symmetric and positive definite.
Eigen::MatrixXd random_normal_matrix(Eigen::Index size, std::uint64_t seed) {
    const Eigen::MatrixXd rows = random_matrix(2 * size, size, seed);
    return rows.transpose() * rows;
}

TEST(SolveSymmetric, FindsWhatTheRightSideWasMadeOf) {
    for (Eigen::Index size = 1; size <= 7; ++size) {
        const SmallMatrix matrix = random_normal_matrix(size, 1);
        const SmallMatrix solution = random_matrix(size, 3, 2);
        EXPECT_LT((solve_symmetric(matrix, matrix * solution) - solution).norm(), 1e-9) << size;
    }
    const Eigen::MatrixXd matrix = random_normal_matrix(40, 3);
    const Eigen::MatrixXd solution = random_matrix(40, 2, 4);
    EXPECT_LT((solve_large_symmetric(matrix, matrix * solution) - solution).norm(), 1e-9);
}

TEST(SolveSymmetric, LeavesWhatNothingDeterminesAtZero) {
    SmallMatrix matrix = SmallMatrix::Zero(2, 2);
    matrix(0, 0) = 2.0;
    SmallMatrix right(2, 1);
    right << 3, 0;
    const SmallMatrix solution = solve_symmetric(matrix, right);
    EXPECT_EQ(solution(0), 1.5);
    EXPECT_EQ(solution(1), 0.0);
}

template <int kSize>
void expect_eigensystem(const Eigen::Matrix<double, kSize, kSize>& matrix) {
    const Eigensystem<kSize> found = eigensystem(matrix);
    for (int i = 0; i < kSize; ++i) {
        EXPECT_LT((matrix * found.vectors.col(i) - found.values[i] * found.vectors.col(i)).norm(),
                  1e-9);
        EXPECT_NEAR(found.vectors.col(i).norm(), 1.0, 1e-12);
    }
    EXPECT_TRUE(std::ranges::is_sorted(found.values));
}

TEST(Eigensystem, HasItsValuesInAscendingOrder) {
    expect_eigensystem<3>(random_normal_matrix(3, 5));
    expect_eigensystem<4>(random_normal_matrix(4, 6));
}

TEST(SingularValues, MakeTheMatrixAgain) {
    const Eigen::Matrix3d matrix = random_matrix(3, 3, 7);
    const SingularValues found = singular_values(matrix);
    const Eigen::Matrix3d again = found.u * found.values.asDiagonal() * found.v.transpose();
    EXPECT_LT((again - matrix).norm(), 1e-12);
    EXPECT_LT((found.u.transpose() * found.u - Eigen::Matrix3d::Identity()).norm(), 1e-12);
    EXPECT_LT((found.v.transpose() * found.v - Eigen::Matrix3d::Identity()).norm(), 1e-12);
    EXPECT_GE(found.values[0], found.values[1]);
    EXPECT_GE(found.values[1], found.values[2]);
    EXPECT_GE(found.values[2], 0.0);
}

}  // namespace
}  // namespace psfm
