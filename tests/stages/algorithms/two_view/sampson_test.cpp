// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/two_view/sampson.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "stages/algorithms/two_view/refine_two_view.h"
#include "tests/stages/verification/two_views.h"

namespace psfm {
namespace {

std::vector<PointPair> normalized_points(const test::TwoViews& views) {
    return make_two_view_problem(views.matched(), 1.0)->normalized;
}

test::TwoViews clean_views() {
    test::TwoViewOptions options;
    options.wrong = 0;
    options.noise_px = 0;
    return make_two_views(options, 1);
}

TEST(Sampson, VanishesAtTheTruth) {
    const test::TwoViews views = clean_views();
    const Eigen::Matrix3d e = fundamental_from_pose(views.cam2_from_cam1, {});
    for (const PointPair& p : normalized_points(views))
        EXPECT_LT(std::abs(sampson_residual(e, p)), 1e-6);
}

TEST(Sampson, IsTheDistanceOfANearbyPointFromItsLine) {
    // Sideways motion: epipolar lines are rows, and an offset of d in one image is d / sqrt(2) in
    // both.
    const Eigen::Matrix3d e = cross_matrix(Eigen::Vector3d::UnitX());
    EXPECT_NEAR(std::abs(sampson_residual(e, {{0.3, 0.1}, {0.5, 0.1 + 0.02}})),
                0.02 / std::sqrt(2.0), 1e-12);
}

TEST(Sampson, DoesNotDivideByAVanishingGradient) {
    EXPECT_EQ(sampson_residual(Eigen::Matrix3d::Zero(), {{0.3, 0.1}, {0.5, 0.1}}), 0.0);
}

TEST(Sampson, GradientIsThatOfTheCost) {
    test::TwoViewOptions options;
    options.matches = 20;
    const std::vector<PointPair> points = normalized_points(make_two_views(options, 3));
    Eigen::Matrix3d f = fundamental_from_pose(clean_views().cam2_from_cam1, {});
    constexpr double kScale = 0.01;
    const SampsonSystem system = linearize_sampson(points, f, kScale);
    EXPECT_NEAR(system.cost, sampson_cost(points, f, kScale), 1e-12);
    for (int i = 0; i < 9; ++i) {
        constexpr double kStep = 1e-7;
        Eigen::Matrix3d above = f;
        Eigen::Matrix3d below = f;
        above.data()[i] += kStep;
        below.data()[i] -= kStep;
        const double slope =
            (sampson_cost(points, above, kScale) - sampson_cost(points, below, kScale)) /
            (2 * kStep);
        EXPECT_NEAR(system.gradient[i], slope, 1e-5 * (1 + std::abs(slope))) << "element " << i;
    }
}

}  // namespace
}  // namespace psfm
