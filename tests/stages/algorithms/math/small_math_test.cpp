// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <utility>
#include <vector>

#include "graph/sorted_unique.h"
#include "stages/algorithms/math/angles.h"
#include "stages/algorithms/math/median.h"
#include "stages/algorithms/math/most_common.h"
#include "stages/algorithms/math/union_find.h"

namespace psfm {
namespace {

TEST(UpperMedian, IsOneOfTheValues) {
    EXPECT_EQ(upper_median(std::vector<double>{5.0}), 5.0);
    EXPECT_EQ(upper_median(std::vector<double>{3.0, 1.0, 2.0}), 2.0);
    EXPECT_EQ(upper_median(std::vector<double>{4.0, 1.0, 3.0, 2.0}), 3.0);
    EXPECT_EQ(upper_median(std::vector<int>{-9, 1, 5}, [](int value) { return std::abs(value); }),
              5);
    EXPECT_EQ(upper_median_or(std::vector<double>{4.0, 1.0}, 7.0), 4.0);
    EXPECT_EQ(upper_median_or(std::vector<double>{}, 7.0), 7.0);
}

TEST(Median, OfAnEvenNumberIsTheMeanOfTheTwoInTheMiddle) {
    EXPECT_EQ(median_or({}, 7.0), 7.0);
    EXPECT_EQ(median_or({5.0}, 7.0), 5.0);
    EXPECT_EQ(median_or({3.0, 1.0, 2.0}, 7.0), 2.0);
    EXPECT_EQ(median_or({4.0, 1.0}, 7.0), 2.5);
    EXPECT_EQ(median_or({9.0, 1.0, 3.0, 2.0}, 7.0), 2.5);
    EXPECT_EQ(median_or({2.0, 2.0, 1.0, 9.0}, 7.0), 2.0);
}

TEST(MostCommon, IsTheSmallestOfThoseThatOccurMost) {
    EXPECT_EQ(most_common(std::vector<int>{7}), std::pair(7, std::size_t{1}));
    EXPECT_EQ(most_common(std::vector<int>{4, 9, 4, 2, 9, 9}), std::pair(9, std::size_t{3}));
    EXPECT_EQ(most_common(std::vector<int>{5, 3, 3, 5, 1}), std::pair(3, std::size_t{2}));
}

TEST(UnionFind, JoinsUnderTheSmallest) {
    UnionFind sets(5);
    EXPECT_TRUE(sets.join(3, 1));
    EXPECT_TRUE(sets.join(4, 3));
    EXPECT_FALSE(sets.join(1, 4));
    EXPECT_EQ(sets.root_of(4), 1U);
    EXPECT_EQ(sets.root_of(0), 0U);
    EXPECT_EQ(sets.add(), 5U);
    EXPECT_EQ(sets.size(), 6U);
}

TEST(UnionFind, AttachesToWhoShallStandForBoth) {
    UnionFind<std::size_t> sets(4);
    sets.attach(0, 2);
    sets.attach(3, 0);
    EXPECT_EQ(sets.root_of(0), 2U);
    EXPECT_EQ(sets.root_of(3), 2U);
    EXPECT_EQ(sets.root_of(1), 1U);
}

TEST(SortUnique, KeepsOneOfEach) {
    std::vector<std::uint32_t> values{3, 1, 3, 2, 1};
    sort_unique(values);
    EXPECT_EQ(values, (std::vector<std::uint32_t>{1, 2, 3}));
    values.clear();
    sort_unique(values);
    EXPECT_TRUE(values.empty());
}

TEST(Angles, BothWays) {
    EXPECT_NEAR(radians_from_degrees(90.0), 1.5707963267948966, 1e-15);
    EXPECT_NEAR(degrees_from_radians(radians_from_degrees(30.0)), 30.0, 1e-13);
    EXPECT_NEAR(kRadiansPerDegree * kDegreesPerRadian, 1.0, 1e-15);
}

}  // namespace
}  // namespace psfm
