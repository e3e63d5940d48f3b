// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/alignment/estimate_sim3.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "tests/stages/merge/cut_scene.h"
#include "tests/synthetic/rng.h"

namespace psfm {
namespace {

using Points = std::vector<Eigen::Vector3d>;

Points random_points(std::size_t count, synthetic::Rng& rng) {
    Points points;
    for (std::size_t k = 0; k < count; ++k)
        points.push_back(3.0 * rng.normal3() + Eigen::Vector3d(9, 2, 1));
    return points;
}

Points moved(const Points& points, const Sim3& sim) {
    Points result;
    for (const Eigen::Vector3d& point : points) result.push_back(sim * point);
    return result;
}

TEST(EstimateSim3, RecoversWhatMadeThePoints) {
    synthetic::Rng rng(1);
    for (const std::size_t count : {3U, 4U, 50U}) {
        const Sim3 truth = synthetic::random_gauge(count);
        const Points source = random_points(count, rng);
        auto found = estimate_sim3(source, moved(source, truth));
        ASSERT_TRUE(found.ok());
        EXPECT_LT(test::difference(*found, truth), 1e-10) << count;
    }
}

TEST(EstimateSim3, NeverReflects) {
    synthetic::Rng rng(2);
    const Points source = random_points(20, rng);
    Points mirrored = source;
    for (Eigen::Vector3d& point : mirrored) point.x() = -point.x();
    auto found = estimate_sim3(source, mirrored);
    ASSERT_TRUE(found.ok());
    EXPECT_NEAR(found->rotation.toRotationMatrix().determinant(), 1.0, 1e-12);
}

TEST(EstimateSim3, WeightsCountAsRepetitions) {
    synthetic::Rng rng(3);
    Points source = random_points(5, rng);
    Points target = random_points(5, rng);
    const std::vector<double> weights{1.0, 2.0, 1.0, 0.0, 3.0};
    auto weighted = estimate_sim3(source, target, weights);
    Points more_source;
    Points more_target;
    for (std::size_t k = 0; k < 5; ++k) {
        for (int repeat = 0; repeat < static_cast<int>(weights[k]); ++repeat) {
            more_source.push_back(source[k]);
            more_target.push_back(target[k]);
        }
    }
    auto repeated = estimate_sim3(more_source, more_target);
    ASSERT_TRUE(weighted.ok() && repeated.ok());
    EXPECT_LT(test::difference(*weighted, *repeated), 1e-9);
}

TEST(EstimateSim3, SaysWhyNot) {
    const Points line{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {5, 5, 5}};
    const Points triangle{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
    const auto code = [](const Points& source, const Points& target,
                         const std::vector<double>& weights = {}) {
        auto found = estimate_sim3(source, target, weights);
        return found.ok() ? ErrorCode::kInternal : found.error().code;
    };
    EXPECT_EQ(code(triangle, triangle), ErrorCode::kInternal);  // stands for success
    EXPECT_EQ(code(line, triangle), ErrorCode::kDegenerate);
    EXPECT_EQ(code(triangle, line), ErrorCode::kDegenerate);
    EXPECT_EQ(code(Points(4, {1, 2, 3}), triangle), ErrorCode::kDegenerate);
    EXPECT_EQ(code({{0, 0, 0}, {1, 0, 0}}, {{0, 0, 0}, {1, 0, 0}}), ErrorCode::kDegenerate);
    EXPECT_EQ(code(triangle, triangle, {1, 1, 0, 0}), ErrorCode::kDegenerate);
    EXPECT_EQ(code({}, {}), ErrorCode::kDegenerate);
    EXPECT_EQ(code(triangle, {{0, 0, 0}}), ErrorCode::kInvalidArgument);
    EXPECT_EQ(code(triangle, triangle, {1, 1}), ErrorCode::kInvalidArgument);
    EXPECT_EQ(code(triangle, triangle, {1, 1, 1, -1}), ErrorCode::kInvalidArgument);
    Points broken = triangle;
    broken[1].x() = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(code(broken, triangle), ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace psfm
