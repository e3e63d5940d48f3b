// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/two_view/sampson_kernel.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "stages/algorithms/two_view/sampson.h"

namespace psfm {
namespace {

constexpr double kSquaredScale = 0.01;

/// The same sums, an error at a time, its derivatives by differences.
SampsonSums sums_of(const std::vector<PointPair>& points, const Eigen::Matrix3d& f) {
    SampsonSums sums;
    for (const PointPair& point : points) {
        const double residual = sampson_residual(f, point);
        const double relative = residual * residual / kSquaredScale;
        sums.log_cost += std::log1p(relative);
        Vector9d jacobian;
        for (int i = 0; i < 9; ++i) {
            constexpr double kStep = 1e-6;
            Eigen::Matrix3d above = f;
            Eigen::Matrix3d below = f;
            above.data()[i] += kStep;
            below.data()[i] -= kStep;
            jacobian[i] =
                (sampson_residual(above, point) - sampson_residual(below, point)) / (2 * kStep);
        }
        std::size_t next = 0;
        for (int row = 0; row < 9; ++row) {
            sums.gradient[static_cast<std::size_t>(row)] +=
                jacobian[row] * residual / (1 + relative);
            for (int column = 0; column <= row; ++column, ++next)
                sums.information[next] += jacobian[row] * jacobian[column] / (1 + relative);
        }
    }
    return sums;
}

SampsonSums run(SampsonKernel kernel, const std::vector<PointPair>& points,
                const Eigen::Matrix3d& f) {
    const double* const coordinates = points.empty() ? nullptr : points.front().x1.data();
    return kernel(coordinates, points.size(), f.data(), kSquaredScale);
}

void expect_near(const SampsonSums& sums, const SampsonSums& expected, const std::string& what) {
    EXPECT_NEAR(sums.log_cost, expected.log_cost, 1e-9 * (1 + expected.log_cost)) << what;
    for (std::size_t i = 0; i < sums.gradient.size(); ++i) {
        EXPECT_NEAR(sums.gradient[i], expected.gradient[i],
                    1e-6 * (1 + std::abs(expected.gradient[i])))
            << what << ", gradient " << i;
    }
    for (std::size_t i = 0; i < sums.information.size(); ++i) {
        EXPECT_NEAR(sums.information[i], expected.information[i],
                    1e-6 * (1 + std::abs(expected.information[i])))
            << what << ", information " << i;
    }
}

TEST(SampsonKernel, EachSumsTheSame) {
    std::mt19937_64 rng(1);
    std::normal_distribution<double> normal;
    const auto random = [&] { return normal(rng); };
    const Eigen::Matrix3d f = Eigen::Matrix3d::NullaryExpr(random);
    ASSERT_STREQ(available_sampson_kernels().back().name, "portable");
    for (const std::size_t count : {0U, 1U, 2U, 3U, 4U, 5U, 7U, 8U, 9U, 31U, 32U, 33U, 100U}) {
        std::vector<PointPair> points(count);
        for (PointPair& point : points) {
            point = {Eigen::Vector2d::NullaryExpr(random), Eigen::Vector2d::NullaryExpr(random)};
        }
        const SampsonSums expected = sums_of(points, f);
        for (const NamedSampsonKernel& kernel : available_sampson_kernels()) {
            expect_near(run(kernel.run, points, f), expected,
                        std::string(kernel.name) + " of " + std::to_string(count));
        }
    }
}

TEST(SampsonKernel, PointsOnBothEpipolesSayNothing) {
    // Forward motion: both epipoles are the origin.
    const Eigen::Matrix3d f = cross_matrix(Eigen::Vector3d::UnitZ());
    const PointPair epipoles;
    const PointPair other{{0.3, 0.1}, {0.4, 0.2}};
    for (const NamedSampsonKernel& kernel : available_sampson_kernels()) {
        const SampsonSums one = run(kernel.run, {other}, f);
        const SampsonSums all = run(kernel.run, {epipoles, other, epipoles}, f);
        EXPECT_GT(one.log_cost, 0.0);
        EXPECT_DOUBLE_EQ(all.log_cost, one.log_cost) << kernel.name;
        for (std::size_t i = 0; i < one.information.size(); ++i)
            EXPECT_DOUBLE_EQ(all.information[i], one.information[i]) << kernel.name << ", " << i;
    }
}

TEST(SampsonKernel, HugeErrorsDoNotOverflowAndTinyOnesAreNotLost) {
    // Sideways motion: epipolar lines are rows.
    const Eigen::Matrix3d f = cross_matrix(Eigen::Vector3d::UnitX());
    const auto off_by = [](double error) { return PointPair{{0.3, 0.1}, {0.5, 0.1 + error}}; };
    for (const NamedSampsonKernel& kernel : available_sampson_kernels()) {
        const std::vector<PointPair> far(64, off_by(1e30));
        EXPECT_NEAR(run(kernel.run, far, f).log_cost, 64 * std::log(0.5e60 / kSquaredScale), 1e-6)
            << kernel.name;
        const std::vector<PointPair> near(64, off_by(1e-8));
        EXPECT_NEAR(run(kernel.run, near, f).log_cost, 64 * 0.5e-16 / kSquaredScale, 1e-18)
            << kernel.name;
    }
}

}  // namespace
}  // namespace psfm
