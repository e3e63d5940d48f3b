// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/adjustment/coupling_kernel.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <random>
#include <vector>

namespace psfm {
namespace {

TEST(CouplingKernel, EachAddsTheProductAndTouchesNothingElse) {
    std::mt19937_64 rng(1);
    std::normal_distribution<double> normal;
    const auto random = [&] { return normal(rng); };
    const auto check = [&](const NamedCouplingKernel& kernel, Eigen::Index rows, Eigen::Index depth,
                           Eigen::Index stride) {
        SCOPED_TRACE(kernel.name);
        SCOPED_TRACE(::testing::Message() << rows << " rows, depth " << depth << ", " << stride);
        const Eigen::MatrixXd left = Eigen::MatrixXd::NullaryExpr(8, depth, random);
        const Eigen::MatrixXd right = Eigen::MatrixXd::NullaryExpr(6, depth, random);
        // The block begins at (1, 0) of the storage; what lies around it has to stay.
        const Eigen::MatrixXd before = Eigen::MatrixXd::NullaryExpr(stride, 8, random);
        Eigen::MatrixXd after = before;
        kernel.run({left.data(), 8, static_cast<std::size_t>(rows)}, right.data(),
                   static_cast<std::size_t>(depth), after.data() + 1,
                   static_cast<std::size_t>(stride));
        Eigen::VectorXd expected = before.reshaped();
        for (Eigen::Index column = 0; column < 6; ++column) {
            expected.segment(1 + column * stride, rows) +=
                left.topRows(rows) * right.row(column).transpose();
        }
        EXPECT_LT((after.reshaped() - expected).cwiseAbs().maxCoeff(), 1e-12);
        Eigen::Index touched = 0;
        for (Eigen::Index i = 0; i < before.size(); ++i)
            touched += before.reshaped()[i] == after.reshaped()[i] ? 0 : 1;
        EXPECT_EQ(touched, 6 * rows);
    };
    ASSERT_STREQ(available_coupling_kernels().back().name, "portable");
    for (const NamedCouplingKernel& kernel : available_coupling_kernels()) {
        for (const Eigen::Index rows : {1, 2, 4, 5, 6, 8}) {
            for (const Eigen::Index depth : {2, 3}) {
                for (const Eigen::Index stride : {8, 96}) check(kernel, rows, depth, stride);
            }
        }
    }
}

}  // namespace
}  // namespace psfm
