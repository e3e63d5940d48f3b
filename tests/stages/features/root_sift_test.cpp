// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/sift/root_sift.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numeric>
#include <random>

namespace psfm {
namespace {

TEST(RootSiftTest, IsTheSquareRootOfTheNormalisedHistogram) {
    std::array<float, 128> sift{};
    std::mt19937 random(1);
    for (float& value : sift) value = static_cast<float>(random() % 180);
    const float sum = std::accumulate(sift.begin(), sift.end(), 0.F);
    std::array<std::uint8_t, 128> root{};
    write_root_sift(sift, root);
    double squares = 0.0;
    for (std::size_t i = 0; i < sift.size(); ++i) {
        EXPECT_EQ(root[i], std::lround(512.0 * std::sqrt(static_cast<double>(sift[i]) / sum))) << i;
        squares += static_cast<double>(root[i]) * root[i];
    }
    EXPECT_NEAR(std::sqrt(squares), 512.0, 3.0);
}

TEST(RootSiftTest, ClampsAndKeepsZero) {
    std::array<float, 128> sift{};
    std::array<std::uint8_t, 128> root{};
    root.fill(9);
    write_root_sift(sift, root);
    for (const std::uint8_t value : root) EXPECT_EQ(value, 0);
    sift[5] = 100.F;
    write_root_sift(sift, root);
    EXPECT_EQ(root[5], 255);
    EXPECT_EQ(root[4], 0);
}

}  // namespace
}  // namespace psfm
