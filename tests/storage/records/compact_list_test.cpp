// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/records/compact_list.h"

#include <gtest/gtest.h>

#include "tests/storage/random_values.h"

namespace psfm {
namespace {

TEST(CompactList, GivesMembersBack) {
    testing::Rng rng(2);
    for (const std::size_t count : {0U, 1U, 2U, 100U, 3000U}) {
        const std::vector<ImageId> members = testing::random_members(count, rng);
        const auto decoded = decode_members(encode_members(members));
        ASSERT_TRUE(decoded);
        EXPECT_EQ(*decoded, members);
    }
    const std::vector<ImageId> extremes{ImageId{0}, ImageId{0x7fffffffU}, ImageId{0xffffffffU}};
    EXPECT_EQ(decode_members(encode_members(extremes)), extremes);
}

TEST(CompactList, TakesAByteAMemberOfADenseCluster) {
    EXPECT_EQ(encode_members(testing::first_images(1000)).size(), 1000U);
}

TEST(CompactList, RefusesEndlessAndTooLargeNumbers) {
    using Bytes = std::vector<std::uint8_t>;
    for (const Bytes& bytes : {Bytes{0x80}, Bytes{0xff, 0xff, 0xff, 0xff, 0x7f},
                               Bytes{0x80, 0x80, 0x80, 0x80, 0x80, 0x01},
                               // the largest id, and one after it
                               Bytes{0xff, 0xff, 0xff, 0xff, 0x0f, 0x00}}) {
        EXPECT_FALSE(decode_members(bytes));
    }
    CompactListReader empty{{}};
    EXPECT_FALSE(empty.take());
}

TEST(CompactList, KnowsAscendingLists) {
    EXPECT_TRUE(strictly_ascending({}));
    EXPECT_TRUE(strictly_ascending(testing::first_images(5)));
    EXPECT_FALSE(strictly_ascending(std::vector<ImageId>{ImageId{1}, ImageId{1}}));
    EXPECT_FALSE(strictly_ascending(std::vector<ImageId>{ImageId{2}, ImageId{1}}));
}

}  // namespace
}  // namespace psfm
