// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/math/kd_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/synthetic/rng.h"

namespace psfm {
namespace {

TEST(KdTree, EqualsASearchThroughAllPoints) {
    synthetic::Rng rng(1);
    for (const std::size_t count : {1U, 2U, 3U, 10U, 200U}) {
        std::vector<Eigen::Vector3d> points;
        for (std::size_t k = 0; k < count; ++k) {
            // Whole numbers, so that coordinates and whole points repeat.
            points.emplace_back(rng.below(4), rng.below(5), rng.below(6));
        }
        const KdTree tree(points);
        for (int query = 0; query < 200; ++query) {
            const Eigen::Vector3d at = 3.0 * rng.normal3();
            const std::size_t excluded = rng.below(2) == 0 ? KdTree::kNone : rng.below(count);
            double expected = std::numeric_limits<double>::infinity();
            for (std::size_t k = 0; k < count; ++k) {
                if (k != excluded) expected = std::min(expected, (points[k] - at).norm());
            }
            ASSERT_DOUBLE_EQ(tree.nearest_distance(at, excluded), expected);
            std::vector<std::uint32_t> within;
            for (std::uint32_t k = 0; k < count; ++k) {
                if ((points[k] - at).norm() < 2.5) within.push_back(k);
            }
            EXPECT_EQ(tree.nearer_than(at, 2.5), within);
            if (std::isinf(expected)) continue;
            EXPECT_FALSE(tree.has_nearer(at, 0.999 * expected, excluded));
            EXPECT_TRUE(tree.has_nearer(at, 1.001 * expected, excluded));
        }
    }
}

TEST(KdTree, EmptyIsInfinitelyFar) {
    EXPECT_TRUE(std::isinf(KdTree().nearest_distance(Eigen::Vector3d::Zero())));
    EXPECT_FALSE(KdTree().has_nearer(Eigen::Vector3d::Zero(), 1e300));
    EXPECT_TRUE(KdTree().nearer_than(Eigen::Vector3d::Zero(), 1e300).empty());
}

}  // namespace
}  // namespace psfm
