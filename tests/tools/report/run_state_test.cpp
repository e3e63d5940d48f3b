// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/report/run_state.h"

#include <gtest/gtest.h>
#include <stdlib.h>
#include <unistd.h>

#include <fstream>

namespace psfm {
namespace {

class RunStateTest : public ::testing::Test {
  protected:
    void SetUp() override {
        std::string pattern = (std::filesystem::temp_directory_path() / "psfm-XXXXXX").string();
        folder_ = mkdtemp(pattern.data());
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }
    std::filesystem::path folder_;
};

TEST_F(RunStateTest, IsReadAsWritten) {
    const RunState state{getpid(), 12.5, 30, 100, 2.5, true, 41.0};
    write_run_state(folder_, state);
    const auto read = read_run_state(folder_);
    ASSERT_TRUE(read.has_value());
    EXPECT_EQ(read->pid, state.pid);
    EXPECT_EQ(read->done, state.done);
    EXPECT_EQ(read->expected, state.expected);
    EXPECT_DOUBLE_EQ(read->seconds, state.seconds);
    EXPECT_DOUBLE_EQ(read->images_per_second, state.images_per_second);
    EXPECT_TRUE(read->settling);
    EXPECT_EQ(read->seconds_left, state.seconds_left);
    remove_run_state(folder_);
    EXPECT_FALSE(read_run_state(folder_).has_value());
}

TEST_F(RunStateTest, WhatADeadProcessLeftIsNothing) {
    constexpr std::int64_t kNobody = 0x3fffffff;  // above the largest pid of Linux
    write_run_state(folder_, {kNobody, 1.0, 1, 1, 1.0, false, {}});
    EXPECT_FALSE(read_run_state(folder_).has_value());
}

TEST_F(RunStateTest, DamageIsNothing) {
    std::ofstream(folder_ / "running.json") << "{\"pid\":\"x\"";
    EXPECT_FALSE(read_run_state(folder_).has_value());
}

}  // namespace
}  // namespace psfm
