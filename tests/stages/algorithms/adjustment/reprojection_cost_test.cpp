// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/adjustment/reprojection_cost.h"

#include <gtest/gtest.h>

#include <array>

namespace psfm {
namespace {

class ReprojectionCostTest : public testing::TestWithParam<CameraModel> {};

std::array<double, 8> parameters_of(CameraModel model) {
    switch (model) {
        case CameraModel::kSimplePinhole:
            return {800, 500, 400};
        case CameraModel::kPinhole:
            return {800, 820, 500, 400};
        case CameraModel::kSimpleRadial:
            return {800, 500, 400, -0.1};
        case CameraModel::kRadial:
            return {800, 500, 400, -0.1, 0.02};
        case CameraModel::kOpenCv:
            return {800, 820, 500, 400, -0.1, 0.02, 0.003, -0.002};
    }
    return {};
}

TEST_P(ReprojectionCostTest, AgreesWithProjectAndItsOwnDifferences) {
    Camera camera;
    camera.model = GetParam();
    camera.width = 1000;
    camera.height = 800;
    camera.params = parameters_of(GetParam());
    const Rigid3 pose{
        Eigen::Quaterniond(Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, -1).normalized())),
        {0.1, -0.2, 0.5}};
    const Eigen::Vector3d point(0.7, -0.3, 3.0);
    const Eigen::Vector2d observed(512, 388);
    const ReprojectionCost cost(GetParam(), observed, 2.0);

    std::array<double, kPoseSize> pose_block{};
    write_pose(pose, pose_block.data());
    std::array<double, 3> point_block{point.x(), point.y(), point.z()};
    std::array<double, kIntrinsicsSize> intrinsics = camera.params;
    std::array<double*, 3> blocks{pose_block.data(), point_block.data(), intrinsics.data()};
    std::array<double, 2> residuals{};
    std::array<double, 2 * kPoseSize> by_pose{};
    std::array<double, 6> by_point{};
    std::array<double, 2 * kIntrinsicsSize> by_intrinsics{};
    std::array<double*, 3> jacobians{by_pose.data(), by_point.data(), by_intrinsics.data()};
    ASSERT_TRUE(cost.Evaluate(blocks.data(), residuals.data(), jacobians.data()));
    const Eigen::Vector2d expected = (*project(camera, pose * point) - observed) / 2.0;
    EXPECT_NEAR(residuals[0], expected.x(), 1e-9);
    EXPECT_NEAR(residuals[1], expected.y(), 1e-9);

    constexpr double kStep = 1e-6;
    const auto evaluate = [&] {
        Eigen::Vector2d r;
        EXPECT_TRUE(cost.Evaluate(blocks.data(), r.data(), nullptr));
        return r;
    };
    const auto expect_column = [&](const double* jacobian, int columns, int column,
                                   const Eigen::Vector2d& difference) {
        EXPECT_NEAR(jacobian[column], difference.x(), 1e-3 + 1e-5 * std::abs(difference.x()))
            << "column " << column;
        EXPECT_NEAR(jacobian[columns + column], difference.y(),
                    1e-3 + 1e-5 * std::abs(difference.y()))
            << "column " << column;
    };
    const PoseManifold manifold;
    for (int i = 0; i < 6; ++i) {
        std::array<double, 6> delta{};
        const std::array<double, kPoseSize> start = pose_block;
        delta.at(static_cast<std::size_t>(i)) = kStep;
        manifold.Plus(start.data(), delta.data(), pose_block.data());
        const Eigen::Vector2d above = evaluate();
        delta.at(static_cast<std::size_t>(i)) = -kStep;
        manifold.Plus(start.data(), delta.data(), pose_block.data());
        const Eigen::Vector2d below = evaluate();
        pose_block = start;
        expect_column(by_pose.data(), kPoseSize, i, (above - below) / (2 * kStep));
    }
    const auto check_block = [&](double* block, int size, const double* jacobian) {
        for (int i = 0; i < size; ++i) {
            const double start = block[i];
            block[i] = start + kStep;
            const Eigen::Vector2d above = evaluate();
            block[i] = start - kStep;
            const Eigen::Vector2d below = evaluate();
            block[i] = start;
            expect_column(jacobian, size, i, (above - below) / (2 * kStep));
        }
    };
    check_block(point_block.data(), 3, by_point.data());
    check_block(intrinsics.data(), kIntrinsicsSize, by_intrinsics.data());
}

INSTANTIATE_TEST_SUITE_P(AllModels, ReprojectionCostTest,
                         testing::Values(CameraModel::kSimplePinhole, CameraModel::kPinhole,
                                         CameraModel::kSimpleRadial, CameraModel::kRadial,
                                         CameraModel::kOpenCv));

TEST(PoseManifold, MinusUndoesPlus) {
    std::array<double, kPoseSize> x{};
    write_pose({Eigen::Quaterniond(Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitY())), {1, 2, 3}},
               x.data());
    const std::array<double, 6> delta{0.1, -0.2, 0.3, 1, -1, 2};
    std::array<double, kPoseSize> y{};
    std::array<double, 6> back{};
    const PoseManifold manifold;
    manifold.Plus(x.data(), delta.data(), y.data());
    manifold.Minus(y.data(), x.data(), back.data());
    for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(back.at(i), delta.at(i), 1e-12);
}

TEST(ReprojectionCost, RefusesPointsBehindTheCamera) {
    const ReprojectionCost cost(CameraModel::kSimplePinhole, {0, 0}, 1.0);
    std::array<double, kPoseSize> pose{};
    write_pose({}, pose.data());
    std::array<double, 3> point{0, 0, -1};
    std::array<double, kIntrinsicsSize> intrinsics{800, 0, 0};
    std::array<double*, 3> blocks{pose.data(), point.data(), intrinsics.data()};
    std::array<double, 2> residuals{};
    EXPECT_FALSE(cost.Evaluate(blocks.data(), residuals.data(), nullptr));
}

}  // namespace
}  // namespace psfm
