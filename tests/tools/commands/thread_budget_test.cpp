// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/console/thread_budget.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <chrono>
#include <opencv2/core/utility.hpp>
#include <set>
#include <thread>
#include <vector>

namespace psfm {
namespace {

/// Threads that OpenCV's loop ran on, seen from within an arena of three; each index is checked to
/// be taken once. Bodies sleep, so that a thread that is free has time to come.
std::set<std::thread::id> threads_of_a_loop() {
    constexpr int kTasks = 40, kArena = 3;
    std::vector<std::atomic<int>> taken(kTasks);
    std::vector<std::thread::id> by_index(kTasks);
    std::atomic<bool> elsewhere = false;
    tbb::task_arena arena(kArena);
    arena.execute([&] {
        cv::parallel_for_(cv::Range(0, kTasks), [&](const cv::Range& range) {
            for (int i = range.start; i < range.end; ++i) {
                ++taken[static_cast<std::size_t>(i)];
                if (tbb::this_task_arena::max_concurrency() != kArena) elsewhere = true;
                by_index[static_cast<std::size_t>(i)] = std::this_thread::get_id();
                std::this_thread::sleep_for(std::chrono::milliseconds(5));
            }
        });
    });
    EXPECT_FALSE(elsewhere);
    for (const std::atomic<int>& count : taken) EXPECT_EQ(count.load(), 1);
    return {by_index.begin(), by_index.end()};
}

TEST(ThreadBudget, OpenCvLoopsRunInTheCallersArena) {
    const ThreadBudget budget(2);
    EXPECT_GE(threads_of_a_loop().size(), 2U);
}

TEST(ThreadBudget, OneThreadIsOne) {
    const ThreadBudget budget(1);
    EXPECT_EQ(threads_of_a_loop(), std::set<std::thread::id>{std::this_thread::get_id()});
}

}  // namespace
}  // namespace psfm
