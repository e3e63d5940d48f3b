// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "graph/ids.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <type_traits>
#include <unordered_set>
#include <vector>

namespace psfm {
namespace {

static_assert(!std::is_convertible_v<ImageId, CameraId>);
static_assert(!std::is_convertible_v<ImageId, std::uint32_t>);
static_assert(!std::is_convertible_v<std::uint32_t, ImageId>);

TEST(ImagePair, IsTheSameInBothDirections) {
    const ImagePair pair = ImagePair::of(ImageId{7}, ImageId{3});
    EXPECT_EQ(pair.first, ImageId{3});
    EXPECT_EQ(pair.second, ImageId{7});
    EXPECT_EQ(pair, ImagePair::of(ImageId{3}, ImageId{7}));
}

TEST(ImagePair, SortsByFirstThenSecond) {
    std::vector<ImagePair> pairs{
        {ImageId{1}, ImageId{2}}, {ImageId{0}, ImageId{9}}, {ImageId{0}, ImageId{2}}};
    std::ranges::sort(pairs);
    EXPECT_EQ(pairs[0], (ImagePair{ImageId{0}, ImageId{2}}));
    EXPECT_EQ(pairs[1], (ImagePair{ImageId{0}, ImageId{9}}));
    EXPECT_EQ(pairs[2], (ImagePair{ImageId{1}, ImageId{2}}));
}

TEST(ImagePair, HashKeepsPairsApart) {
    std::unordered_set<ImagePair, ImagePairHash> pairs;
    std::unordered_set<std::size_t> hashes;
    for (std::uint32_t b = 1; b < 60; ++b) {
        for (std::uint32_t a = 0; a < b; ++a) {
            const ImagePair pair = ImagePair::of(ImageId{a}, ImageId{b});
            EXPECT_TRUE(pairs.insert(pair).second);
            hashes.insert(ImagePairHash{}(pair));
        }
    }
    EXPECT_EQ(hashes.size(), pairs.size());
}

TEST(IndexOf, IsTheNumber) {
    EXPECT_EQ(index_of(ClusterId{4000000000U}), 4000000000U);
}

}  // namespace
}  // namespace psfm
