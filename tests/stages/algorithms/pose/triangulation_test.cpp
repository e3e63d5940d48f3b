// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/pose/triangulation.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <numbers>

namespace psfm {
namespace {

TEST(Triangulate, FindsThePointOfTwoViews) {
    const Eigen::Vector3d point(0.3, -0.2, 4.0);
    const Rigid3 left;
    const Rigid3 right{Eigen::Quaterniond(Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitY())),
                       {-1.0, 0.1, 0.0}};
    const std::array<View, 2> views{View{left, (left * point).hnormalized()},
                                    View{right, (right * point).hnormalized()}};
    const auto found = triangulate(views);
    ASSERT_TRUE(found.has_value());
    EXPECT_LT((*found - point).norm(), 1e-9);
}

TEST(Triangulate, RefusesPointsBehindACamera) {
    const Rigid3 left;
    const Rigid3 right{Eigen::Quaterniond::Identity(), {-1.0, 0.0, 0.0}};
    // Rays that diverge in front of the cameras meet behind them.
    const std::array<View, 2> views{View{left, {-0.5, 0.0}}, View{right, {0.5, 0.0}}};
    EXPECT_FALSE(triangulate(views).has_value());
}

TEST(TriangulationAngle, IsTheAcuteOne) {
    EXPECT_NEAR(triangulation_angle({-1, 0, 0}, {1, 0, 0}, {0, 0, 1}), std::numbers::pi / 2, 1e-12);
    EXPECT_NEAR(triangulation_angle({-1, 0, 0}, {1, 0, 0}, {0, 0, 0}), 0.0, 1e-12);
}

}  // namespace
}  // namespace psfm
