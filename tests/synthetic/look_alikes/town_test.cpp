// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/synthetic/look_alikes/town.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace psfm::synthetic {
namespace {

// Two by two blocks of 40 m: their middles at (+-27, +-27), streets along both axes.

TEST(Town, HasSidesAlongItsStreetsOnly) {
    const Town town(2);
    ASSERT_EQ(town.sides().size(), 8U);
    for (const TownSide& side : town.sides()) {
        // 7 m from the middle of a street, which the side faces.
        EXPECT_DOUBLE_EQ(side.foot.dot(side.normal), -7.0);
    }
    EXPECT_EQ(Town(3).sides().size(), 24U);
    EXPECT_EQ(town.streets().size(), town.street_count());
    EXPECT_EQ(Town(5).streets().size(), Town(5).street_count());
    EXPECT_DOUBLE_EQ(town.street_length(), 94.0);
}

TEST(Town, BlocksHide) {
    const Town town(2);
    const Eigen::Vector3d crossing(0, 0, 1.7);
    EXPECT_FALSE(town.hides(crossing, {7, 30, 4})) << "a facade of the street ahead";
    EXPECT_FALSE(town.hides(crossing, {7.3, 30, 4})) << "within its relief";
    EXPECT_TRUE(town.hides(crossing, {47, 30, 4})) << "the back of that block";
    EXPECT_TRUE(town.hides({30, 0, 2}, {0, 30, 2})) << "round a corner";
    EXPECT_FALSE(town.hides({7, 0, 2}, {0, 7, 2})) << "near the corner";
    EXPECT_FALSE(town.hides({0, -60, 2}, {0, 60, 2})) << "along the whole street";
    EXPECT_TRUE(town.hides({-60, 27, 2}, {60, 27, 2})) << "through two blocks";
}

TEST(Town, KnowsSidesNear) {
    const Town town(8);
    std::vector<std::size_t> seen;
    for (const std::size_t side : town.sides_near({0, 0, 2})) {
        EXPECT_LT(town.sides()[side].foot.norm(), 140.0);
        seen.push_back(side);
    }
    EXPECT_EQ(seen.size(), 36U);
    EXPECT_TRUE(std::ranges::is_sorted(seen));
    for (std::size_t side = 0; side < town.sides().size(); ++side) {
        if (town.sides()[side].foot.norm() > 54.0) continue;
        EXPECT_TRUE(std::ranges::binary_search(seen, side)) << side;
    }
    EXPECT_FALSE(town.sides_near({1000, 1000, 0}).empty()) << "out of town: the nearest";
}

}  // namespace
}  // namespace psfm::synthetic
