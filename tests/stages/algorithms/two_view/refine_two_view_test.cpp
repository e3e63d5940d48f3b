// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/two_view/refine_two_view.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/SVD>

#include "tests/stages/verification/two_views.h"

namespace psfm {
namespace {

/// Points and intrinsics in units of 1000 px.
struct Problem {
    std::vector<PointPair> points;
    IntrinsicPair intrinsics;
    Rigid3 truth;
};

Problem make_problem(double noise_px, double wrong) {
    test::TwoViewOptions options;
    options.noise_px = noise_px;
    options.wrong = wrong;
    options.camera2 = make_camera(1500, 1000, 2100, FocalSource::kGiven);
    const test::TwoViews views = make_two_views(options, 5);
    Problem problem{make_two_view_problem(views.matched(), 1.0)->pixels, {}, views.cam2_from_cam1};
    const Eigen::Matrix3d unit_from_px = Eigen::Vector3d(1e-3, 1e-3, 1).asDiagonal();
    problem.intrinsics = {unit_from_px * views.camera1.matrix(),
                          unit_from_px * views.camera2.matrix()};
    for (PointPair& p : problem.points) p = {1e-3 * p.x1, 1e-3 * p.x2};
    return problem;
}

RefineOptions one_pixel() {
    RefineOptions options;
    options.loss_scale = 1e-3;
    options.cost_tolerance = 1e-14;
    options.max_iterations = 50;
    return options;
}

Rigid3 disturbed(const Rigid3& pose) {
    Eigen::Matrix<double, 5, 1> step;
    step << 0.02, -0.01, 0.015, 0.05, -0.04;
    return moved_pose(pose, step);
}

TEST(RefineRelativePose, StaysAtAnExactSolution) {
    const Problem problem = make_problem(0, 0);
    const Rigid3 refined =
        refine_relative_pose(problem.points, problem.intrinsics, problem.truth, one_pixel());
    EXPECT_LT(test::rotation_error_deg(refined, problem.truth), 1e-4);
    EXPECT_LT(test::direction_error_deg(refined, problem.truth), 1e-4);
}

TEST(RefineRelativePose, ReturnsToTheTruthDespiteWrongMatches) {
    const Problem problem = make_problem(0.5, 0.1);
    const Rigid3 start = disturbed(problem.truth);
    ASSERT_GT(test::rotation_error_deg(start, problem.truth), 1.0);
    const Rigid3 refined =
        refine_relative_pose(problem.points, problem.intrinsics, start, one_pixel());
    EXPECT_LT(test::rotation_error_deg(refined, problem.truth), 0.1);
    EXPECT_LT(test::direction_error_deg(refined, problem.truth), 0.3);
    EXPECT_NEAR(refined.translation.norm(), 1.0, 1e-12);
    const auto cost = [&](const Rigid3& pose) {
        return sampson_cost(problem.points, fundamental_from_pose(pose, problem.intrinsics), 1e-3);
    };
    EXPECT_LT(cost(refined), cost(start));
    EXPECT_LE(cost(refined), cost(problem.truth));
}

TEST(RefineRelativePose, JacobianIsTheDerivative) {
    const Problem problem = make_problem(0.5, 0);
    const auto jacobian = pose_jacobian(problem.truth, problem.intrinsics);
    for (int i = 0; i < 5; ++i) {
        constexpr double kStep = 1e-6;
        const Eigen::Matrix<double, 5, 1> step = kStep * Eigen::Matrix<double, 5, 1>::Unit(i);
        const Eigen::Matrix3d slope =
            (fundamental_from_pose(moved_pose(problem.truth, step), problem.intrinsics) -
             fundamental_from_pose(moved_pose(problem.truth, -step), problem.intrinsics)) /
            (2 * kStep);
        EXPECT_LT((Eigen::Map<const Vector9d>(slope.data()) - jacobian.col(i)).norm(), 1e-6)
            << "parameter " << i;
    }
}

TEST(RefineFundamental, KeepsRankTwoAndLowersTheCost) {
    const Problem problem = make_problem(0.5, 0.1);
    const Eigen::Matrix3d start =
        fundamental_from_pose(disturbed(problem.truth), problem.intrinsics);
    const Eigen::Matrix3d refined = refine_fundamental(problem.points, start, one_pixel());
    const Eigen::Vector3d singular = Eigen::JacobiSVD<Eigen::Matrix3d>(refined).singularValues();
    EXPECT_LT(singular[2], 1e-12 * singular[0]);
    EXPECT_NEAR(refined.norm(), 1.0, 1e-12);
    const double truth_cost = sampson_cost(
        problem.points, fundamental_from_pose(problem.truth, problem.intrinsics), 1e-3);
    EXPECT_LE(sampson_cost(problem.points, refined, 1e-3), truth_cost);
}

}  // namespace
}  // namespace psfm
