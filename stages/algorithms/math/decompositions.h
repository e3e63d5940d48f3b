// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace psfm {

// Eigen's decompositions in the sizes that psfm needs, compiled once: wherever one is used
// directly, the compiler spends up to ten seconds on its templates. All are thread-safe.

/// Up to seven rows and columns, without memory of its own.
using SmallMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 7, 7>;

/// The solutions of matrix * x = right, column by column, by L D L' with pivoting.
/// @param matrix  symmetric and positive semidefinite, its lower triangle is read; what a singular
/// one leaves open is zero. Of an indefinite one the result may be anything
SmallMatrix solve_symmetric(const SmallMatrix& matrix, const SmallMatrix& right);
/// The same for as many unknowns as there are.
Eigen::MatrixXd solve_large_symmetric(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right);

template <int kSize>
struct Eigensystem {
    Eigen::Matrix<double, kSize, 1> values;       ///< ascending
    Eigen::Matrix<double, kSize, kSize> vectors;  ///< columns, of norm 1
};

/// Of a symmetric matrix, whose lower triangle is read.
Eigensystem<3> eigensystem(const Eigen::Matrix3d& matrix);
Eigensystem<4> eigensystem(const Eigen::Matrix4d& matrix);

/// matrix = u * values.asDiagonal() * v'.
struct SingularValues {
    Eigen::Matrix3d u;       ///< orthogonal, of either determinant
    Eigen::Vector3d values;  ///< descending, none negative
    Eigen::Matrix3d v;       ///< orthogonal, of either determinant
};
SingularValues singular_values(const Eigen::Matrix3d& matrix);

}  // namespace psfm
