// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/session/decoded_cache.h"

#include <gtest/gtest.h>

#include <string>
#include <thread>
#include <vector>

namespace psfm {
namespace {

using Key = DecodedCache::Key;

Key key(std::uint32_t id) {
    return {RecordKind::kDescriptors, id, 0};
}
std::shared_ptr<const std::string> text(const char* value) {
    return std::make_shared<const std::string>(value);
}

TEST(DecodedCache, DropsTheLeastRecentlyUsed) {
    DecodedCache cache(30);
    cache.put(key(1), text("one"), 10);
    cache.put(key(2), text("two"), 10);
    cache.put(key(3), text("three"), 10);
    ASSERT_NE(cache.find<std::string>(key(1)), nullptr);
    cache.put(key(4), text("four"), 10);
    EXPECT_EQ(cache.find<std::string>(key(2)), nullptr);
    EXPECT_EQ(*cache.find<std::string>(key(1)), "one");
    EXPECT_EQ(*cache.find<std::string>(key(4)), "four");
    EXPECT_EQ(cache.used_bytes(), 30U);
}

TEST(DecodedCache, KeepsNothingAboveItsCapacity) {
    DecodedCache cache(30);
    cache.put(key(1), text("one"), 10);
    cache.put(key(2), text("huge"), 31);
    EXPECT_EQ(cache.find<std::string>(key(2)), nullptr);
    EXPECT_NE(cache.find<std::string>(key(1)), nullptr);
    cache.put(key(3), text("all"), 30);
    EXPECT_EQ(cache.used_bytes(), 30U);
    EXPECT_EQ(cache.find<std::string>(key(1)), nullptr);
}

TEST(DecodedCache, GivesUpWhatOthersNeedDownToAQuarter) {
    DecodedCache cache(40);
    for (std::uint32_t id = 1; id <= 4; ++id) cache.put(key(id), text("ten"), 10);
    cache.give_up(15);
    EXPECT_EQ(cache.used_bytes(), 20U);
    EXPECT_EQ(cache.find<std::string>(key(2)), nullptr) << "used longest ago";
    EXPECT_NE(cache.find<std::string>(key(3)), nullptr);
    cache.put(key(5), text("too large now"), 26);
    EXPECT_EQ(cache.used_bytes(), 20U);
    cache.give_up(1000);
    EXPECT_EQ(cache.used_bytes(), 10U);
    cache.put(key(6), text("ten"), 10);
    EXPECT_NE(cache.find<std::string>(key(6)), nullptr);
    cache.take_back();
    cache.put(key(7), text("the rest"), 30);
    EXPECT_EQ(cache.used_bytes(), 40U);
}

TEST(DecodedCache, ForgetsWhatIsAnotherValueByNow) {
    DecodedCache cache(20);
    cache.put(key(1), text("one"), 10);
    cache.put(key(2), text("two"), 10);
    cache.drop(key(1));
    cache.drop(key(3));
    EXPECT_EQ(cache.find<std::string>(key(1)), nullptr);
    EXPECT_NE(cache.find<std::string>(key(2)), nullptr);
    EXPECT_EQ(cache.used_bytes(), 10U);
    cache.put(key(1), text("another one"), 10);
    EXPECT_EQ(*cache.find<std::string>(key(1)), "another one");
}

TEST(DecodedCache, TellsKindsAndRevisionsApart) {
    DecodedCache cache(100);
    cache.put({RecordKind::kPoses, 1, 1}, text("poses"), 1);
    cache.put({RecordKind::kPoints, 1, 1}, text("points"), 1);
    cache.put({RecordKind::kPoints, 1, 2}, text("later points"), 1);
    EXPECT_EQ(*cache.find<std::string>({RecordKind::kPoses, 1, 1}), "poses");
    EXPECT_EQ(*cache.find<std::string>({RecordKind::kPoints, 1, 1}), "points");
}

TEST(DecodedCache, StaysWithinBoundsUnderManyThreads) {
    DecodedCache cache(50);
    std::vector<std::jthread> threads;
    for (std::uint32_t t = 0; t < 4; ++t) {
        threads.emplace_back([&cache, t] {
            if (t == 0) cache.give_up(10);
            for (std::uint32_t i = 0; i < 2000; ++i) {
                const std::uint32_t id = (i * 7 + t) % 20;
                cache.put(key(id), text(std::to_string(id).c_str()), 10);
                const auto found = cache.find<std::string>(key(id));
                if (found) {
                    EXPECT_EQ(*found, std::to_string(id));
                }
            }
        });
    }
    threads.clear();
    EXPECT_LE(cache.used_bytes(), 40U);
}

}  // namespace
}  // namespace psfm
