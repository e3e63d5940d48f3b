// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/adjustment/coupling_kernel.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <random>
#include <vector>

namespace psfm {
namespace {

TEST(CouplingKernel, EachSubtractsTheProductAndTouchesNothingElse) {
    std::mt19937_64 rng(1);
    std::normal_distribution<double> normal;
    const auto random = [&] { return normal(rng); };
    ASSERT_STREQ(available_coupling_kernels().back().name, "portable");
    for (const NamedCouplingKernel& kernel : available_coupling_kernels()) {
        for (const Eigen::Index stride : {6, 7, 96}) {
            const Eigen::Matrix<double, 6, 3> cross =
                Eigen::Matrix<double, 6, 3>::NullaryExpr(6, 3, random);
            const Eigen::Matrix<double, 6, 3> scaled =
                Eigen::Matrix<double, 6, 3>::NullaryExpr(6, 3, random);
            // The block begins at (1, 0) of the storage; what lies around it has to stay.
            const Eigen::MatrixXd before = Eigen::MatrixXd::NullaryExpr(stride, 8, random);
            Eigen::MatrixXd after = before;
            kernel.run(cross.data(), scaled.data(), after.data() + 1,
                       static_cast<std::size_t>(stride));
            Eigen::VectorXd expected = before.reshaped();
            for (Eigen::Index column = 0; column < 6; ++column) {
                expected.segment<6>(1 + column * stride) -= cross * scaled.row(column).transpose();
            }
            EXPECT_LT((after.reshaped() - expected).cwiseAbs().maxCoeff(), 1e-12)
                << kernel.name << ", " << stride;
            std::size_t touched = 0;
            for (Eigen::Index i = 0; i < before.size(); ++i)
                touched += before.reshaped()[i] == after.reshaped()[i] ? 0 : 1;
            EXPECT_EQ(touched, 36U) << kernel.name << ", " << stride;
        }
    }
}

}  // namespace
}  // namespace psfm
