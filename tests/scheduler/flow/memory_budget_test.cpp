// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/flow/memory_budget.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

namespace psfm {
namespace {

using namespace std::chrono_literals;

TEST(MemoryBudgetTest, LetsInWhatFits) {
    MemoryBudget budget(100);
    EXPECT_TRUE(budget.acquire_for(60, 0ms));
    EXPECT_TRUE(budget.acquire_for(40, 0ms));
    EXPECT_FALSE(budget.acquire_for(1, 1ms));
    budget.release(60);
    EXPECT_FALSE(budget.acquire_for(61, 1ms));
    EXPECT_TRUE(budget.acquire_for(60, 0ms));
    EXPECT_EQ(budget.taken(), 100U);
}

TEST(MemoryBudgetTest, WhatIsLargerThanAllOfItComesInAlone) {
    MemoryBudget budget(100);
    EXPECT_TRUE(budget.acquire_for(1, 0ms));
    EXPECT_FALSE(budget.acquire_for(500, 1ms));
    budget.release(1);
    EXPECT_TRUE(budget.acquire_for(500, 0ms));
    EXPECT_FALSE(budget.acquire_for(1, 1ms));
    budget.release(500);
    EXPECT_TRUE(budget.acquire_for(1, 0ms));
}

TEST(MemoryBudgetTest, IsNeverExceededByManyThreads) {
    MemoryBudget budget(10);
    std::atomic<int> inside{0};
    std::atomic<int> most{0};
    std::vector<std::thread> threads;
    for (int i = 0; i < 4; ++i) {
        threads.emplace_back([&] {
            for (int k = 0; k < 200; ++k) {
                while (!budget.acquire_for(4, 10ms)) {
                }
                const int now = ++inside;
                int known = most.load();
                while (known < now && !most.compare_exchange_weak(known, now)) {
                }
                --inside;
                budget.release(4);
            }
        });
    }
    for (std::thread& thread : threads) thread.join();
    EXPECT_LE(most.load(), 2);
    EXPECT_EQ(budget.taken(), 0U);
}

}  // namespace
}  // namespace psfm
