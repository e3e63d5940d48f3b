// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/session/photo_order.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>

namespace psfm {
namespace {

TEST(ShuffledNames, FollowTheWrittenRule) {
    // Worked out by hand from the rule with mt19937_64(1): 2469588189546311528,
    // 2516265689700432462, …
    const std::vector<std::string> names{"c", "a", "b"};
    // i = 2: 2469588189546311528 mod 3 = 2, stays; i = 1: 2516265689700432462 mod 2 = 0, swaps a
    // and b.
    EXPECT_EQ(shuffled_names(names, 1), (std::vector<std::string>{"b", "a", "c"}));
}

TEST(ShuffledNames, AreAPermutationThatTheInputsOrderDoesNotChange) {
    std::vector<std::string> names;
    for (int i = 0; i < 50; ++i) names.push_back(std::to_string(i));
    std::vector<std::string> reversed(names.rbegin(), names.rend());
    const auto shuffled = shuffled_names(names, 7);
    EXPECT_EQ(shuffled, shuffled_names(reversed, 7));
    EXPECT_NE(shuffled, shuffled_names(names, 8));
    EXPECT_TRUE(std::ranges::is_permutation(shuffled, names));
}

class OrderFileTest : public testing::Test {
  protected:
    std::filesystem::path write(const std::string& content) {
        std::ofstream(file_) << content;
        return file_;
    }
    void TearDown() override { std::filesystem::remove(file_); }

  private:
    std::filesystem::path file_ =
        std::filesystem::temp_directory_path() / ("psfm_order_" + std::to_string(getpid()));
};

TEST_F(OrderFileTest, ReadsNames) {
    const auto names = read_order_file(write("b.jpg\r\n\na/x.jpg\nlast"));
    ASSERT_TRUE(names.ok());
    EXPECT_EQ(*names, (std::vector<std::string>{"b.jpg", "a/x.jpg", "last"}));
}

TEST_F(OrderFileTest, NamesWhatIsWrong) {
    EXPECT_EQ(read_order_file("/no/such/file").error().code, ErrorCode::kNotFound);
    EXPECT_EQ(read_order_file(write("\n\n")).error().code, ErrorCode::kInvalidArgument);
    EXPECT_EQ(read_order_file(write(std::string(5000, 'x'))).error().code,
              ErrorCode::kInvalidArgument);
    const auto twice = read_order_file(write("a\nb\na\n"));
    ASSERT_FALSE(twice.ok());
    for (const char* name : {"../a.jpg", "/a.jpg", "a/../../b", "a\x02", "\xff"}) {
        const auto refused = read_order_file(write(std::string("a\n") + name));
        ASSERT_FALSE(refused.ok()) << name;
        EXPECT_EQ(refused.error().code, ErrorCode::kInvalidArgument);
        EXPECT_NE(refused.error().message.find("line 2"), std::string::npos);
    }
    EXPECT_FALSE(read_order_file("/dev/zero").ok()) << "has no end";
    EXPECT_NE(twice.error().message.find("line 3"), std::string::npos);
}

}  // namespace
}  // namespace psfm
