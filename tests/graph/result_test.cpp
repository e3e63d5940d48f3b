// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "graph/result.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

namespace psfm {
namespace {

Result<int> half(int value) {
    if (value % 2 != 0)
        return Error{ErrorCode::kInvalidArgument, std::to_string(value) + " is odd"};
    return value / 2;
}

Result<void> only_even(int value) {
    if (const auto result = half(value); !result) return result.error();
    return {};
}

TEST(Result, HoldsAValue) {
    const Result<int> result = half(8);
    ASSERT_TRUE(result.ok());
    EXPECT_TRUE(static_cast<bool>(result));
    EXPECT_EQ(*result, 4);
    EXPECT_EQ(result.value(), 4);
}

TEST(Result, HoldsAnError) {
    const Result<int> result = half(7);
    ASSERT_FALSE(result.ok());
    EXPECT_FALSE(static_cast<bool>(result));
    EXPECT_EQ(result.error().code, ErrorCode::kInvalidArgument);
    EXPECT_EQ(result.error().message, "7 is odd");
}

TEST(Result, GivesItsValueAway) {
    Result<std::unique_ptr<int>> result = std::make_unique<int>(5);
    const std::unique_ptr<int> taken = std::move(result).value();
    ASSERT_NE(taken, nullptr);
    EXPECT_EQ(*taken, 5);
}

TEST(Result, ReachesIntoItsValue) {
    Result<std::vector<int>> result = std::vector<int>{1, 2};
    result->push_back(3);
    (*result)[0] = 9;
    EXPECT_EQ(result.value(), (std::vector<int>{9, 2, 3}));
    EXPECT_EQ(std::as_const(result)->size(), 3U);
}

TEST(Result, CopiesKeepTheirKind) {
    const Result<int> good = half(2);
    const Result<int> bad = half(3);
    Result<int> copy = good;
    EXPECT_TRUE(copy.ok());
    copy = bad;
    ASSERT_FALSE(copy.ok());
    EXPECT_EQ(copy.error().message, "3 is odd");
}

TEST(Result, OfAStringIsNoError) {
    const Result<std::string> result = std::string("an Error would hold a message too");
    EXPECT_TRUE(result.ok());
}

TEST(Result, OfNothingSucceedsOrFails) {
    EXPECT_TRUE(Result<void>().ok());
    EXPECT_TRUE(only_even(4).ok());
    const Result<void> result = only_even(5);
    ASSERT_FALSE(result.ok());
    EXPECT_EQ(result.error().message, "5 is odd");
}

}  // namespace
}  // namespace psfm
