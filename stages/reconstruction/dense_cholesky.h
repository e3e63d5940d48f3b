// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace psfm {

/// Cholesky factorisation in place, by blocks, with TBB's threads where they are free: the lower
/// triangle of a symmetric positive definite matrix becomes L of L L' (the upper one is not looked
/// at). The result does not depend on the threads.
/// @return false when the matrix is not positive definite
bool factorize_cholesky(Eigen::MatrixXd& matrix);

/// Solves L L' x = b in place. REQUIRES: factorize_cholesky has succeeded
void solve_cholesky(const Eigen::MatrixXd& factor, Eigen::VectorXd& right_side);

}  // namespace psfm
