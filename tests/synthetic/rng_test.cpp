// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/synthetic/rng.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "graph/rigid3.h"

namespace psfm::synthetic {
namespace {

TEST(Rng, GivesTheSameNumbersEverywhere) {
    // The C++ standard fixes mt19937_64: its 10000th number from the default seed 5489.
    Rng rng(5489);
    std::uint64_t value = 0;
    for (int i = 0; i < 10000; ++i) value = rng.bits();
    EXPECT_EQ(value, 9981545732273789042ULL);
}

TEST(Rng, UniformFillsItsRangeEvenly) {
    Rng rng(1);
    std::array<int, 10> bins{};
    for (int i = 0; i < 100000; ++i) {
        const double value = rng.uniform(-2.0, 3.0);
        ASSERT_GE(value, -2.0);
        ASSERT_LT(value, 3.0);
        ++bins.at(static_cast<std::size_t>((value + 2.0) * 2.0));
    }
    for (const int count : bins) EXPECT_NEAR(count, 10000, 400);
}

TEST(Rng, BelowReachesEveryNumber) {
    Rng rng(2);
    std::array<int, 7> bins{};
    for (int i = 0; i < 70000; ++i) ++bins.at(rng.below(7));
    for (const int count : bins) EXPECT_NEAR(count, 10000, 400);
    EXPECT_EQ(rng.below(1), 0U);
}

TEST(Rng, NormalHasMeanZeroAndVarianceOne) {
    Rng rng(3);
    constexpr int kCount = 200000;
    double sum = 0.0;
    double squares = 0.0;
    int beyond_two = 0;
    for (int i = 0; i < kCount; ++i) {
        const double value = rng.normal();
        sum += value;
        squares += value * value;
        beyond_two += std::abs(value) > 2.0 ? 1 : 0;
    }
    EXPECT_NEAR(sum / kCount, 0.0, 0.01);
    EXPECT_NEAR(squares / kCount, 1.0, 0.02);
    EXPECT_NEAR(static_cast<double>(beyond_two) / kCount, 0.0455, 0.002);
}

TEST(Rng, DirectionsAndRotationsHaveNoFavourites) {
    Rng rng(4);
    Eigen::Vector3d directions = Eigen::Vector3d::Zero();
    Eigen::Vector3d turned = Eigen::Vector3d::Zero();
    for (int i = 0; i < 50000; ++i) {
        const Eigen::Vector3d direction = rng.direction();
        ASSERT_NEAR(direction.norm(), 1.0, 1e-12);
        directions += direction;
        const Eigen::Quaterniond rotation = rng.rotation();
        ASSERT_NEAR(rotation.norm(), 1.0, 1e-12);
        turned += rotation * Eigen::Vector3d::UnitX();
    }
    EXPECT_LT(directions.norm() / 50000, 0.015);
    EXPECT_LT(turned.norm() / 50000, 0.015);
}

TEST(Rng, SmallRotationsHaveTheAngleAskedFor) {
    Rng rng(5);
    double squares = 0.0;
    for (int i = 0; i < 20000; ++i) {
        const double angle = rotation_angle(rng.small_rotation(0.01));
        squares += angle * angle;
    }
    EXPECT_NEAR(std::sqrt(squares / 20000), 0.01, 0.0003);
}

TEST(RandomOrder, IsAPermutationThatDependsOnTheSeed) {
    const std::vector<std::size_t> order = random_order(100, 1);
    std::vector<std::size_t> sorted = order;
    std::ranges::sort(sorted);
    for (std::size_t i = 0; i < 100; ++i) EXPECT_EQ(sorted[i], i);
    EXPECT_EQ(order, random_order(100, 1));
    EXPECT_NE(order, random_order(100, 2));
    EXPECT_TRUE(random_order(0, 1).empty());
}

TEST(MixSeed, KeepsNeighboursApart) {
    std::set<std::uint64_t> seen;
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
        for (std::uint64_t value = 0; value < 100; ++value) seen.insert(mix_seed(seed, value));
    }
    EXPECT_EQ(seen.size(), 10000U);
}

}  // namespace
}  // namespace psfm::synthetic
