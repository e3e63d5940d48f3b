// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/math/decompositions.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

namespace psfm {
namespace {

/// Column by column: of several at a time, Eigen makes a product of large blocks.
template <typename Matrix>
Matrix solve_columns(const Matrix& matrix, Matrix right) {
    const Eigen::LDLT<Matrix> factor(matrix);
    for (Eigen::Index column = 0; column < right.cols(); ++column)
        right.col(column) = factor.solve(right.col(column));
    return right;
}

template <int kSize>
Eigensystem<kSize> eigensystem_of(const Eigen::Matrix<double, kSize, kSize>& matrix) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, kSize, kSize>> solver(matrix);
    return {solver.eigenvalues(), solver.eigenvectors()};
}

}  // namespace

SmallMatrix solve_symmetric(const SmallMatrix& matrix, const SmallMatrix& right) {
    return solve_columns(matrix, right);
}

Eigen::MatrixXd solve_large_symmetric(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right) {
    return solve_columns(matrix, right);
}

Eigensystem<3> eigensystem(const Eigen::Matrix3d& matrix) {
    return eigensystem_of(matrix);
}
Eigensystem<4> eigensystem(const Eigen::Matrix4d& matrix) {
    return eigensystem_of(matrix);
}

SingularValues singular_values(const Eigen::Matrix3d& matrix) {
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
    return {svd.matrixU(), svd.singularValues(), svd.matrixV()};
}

}  // namespace psfm
