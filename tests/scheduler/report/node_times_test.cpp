// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/report/node_times.h"

#include <gtest/gtest.h>

#include <thread>

namespace psfm {
namespace {

using namespace std::chrono_literals;

/// Moments are given, so that nothing here depends on the machine.
class NodeTimesTest : public testing::Test {
  protected:
    NodeUsage solve_at(std::chrono::seconds at) {
        return times.usage(start + at).nodes[static_cast<std::size_t>(GraphNode::kSolve)];
    }
    NodeTimes::Clock::time_point start = NodeTimes::Clock::now();
    NodeTimes times{start};
};

TEST_F(NodeTimesTest, AnIdleNodeIsStarved) {
    const GraphUsage usage = times.usage(start + 5s);
    EXPECT_DOUBLE_EQ(usage.seconds, 5.0);
    ASSERT_EQ(usage.nodes.size(), 7U);
    for (std::size_t i = 0; i < usage.nodes.size(); ++i) {
        EXPECT_EQ(usage.nodes[i].node, static_cast<GraphNode>(i));
        EXPECT_DOUBLE_EQ(usage.nodes[i].starved_s, 5.0);
        EXPECT_DOUBLE_EQ(usage.nodes[i].busy_s + usage.nodes[i].waiting_s, 0.0);
    }
}

TEST_F(NodeTimesTest, WaitsFromArrivalUntilItBegins) {
    times.arrived(GraphNode::kSolve, 1, start + 2s);
    times.begin(GraphNode::kSolve, start + 5s);
    times.end(GraphNode::kSolve, start + 9s);
    const NodeUsage usage = solve_at(10s);
    EXPECT_EQ(usage.runs, 1U);
    EXPECT_DOUBLE_EQ(usage.starved_s, 3.0);
    EXPECT_DOUBLE_EQ(usage.waiting_s, 3.0);
    EXPECT_DOUBLE_EQ(usage.busy_s, 4.0);
    EXPECT_DOUBLE_EQ(usage.work_s, 4.0);
    EXPECT_DOUBLE_EQ(usage.queued_s, 3.0);
}

TEST_F(NodeTimesTest, RunsBesideOneAnotherAreBusyOnceAndWorkTwice) {
    times.arrived(GraphNode::kSolve, 2, start);
    times.begin(GraphNode::kSolve, start);
    times.begin(GraphNode::kSolve, start + 1s);
    times.end(GraphNode::kSolve, start + 3s);
    times.end(GraphNode::kSolve, start + 4s);
    const NodeUsage usage = solve_at(4s);
    EXPECT_EQ(usage.runs, 2U);
    EXPECT_DOUBLE_EQ(usage.busy_s, 4.0);
    EXPECT_DOUBLE_EQ(usage.work_s, 6.0);
    EXPECT_DOUBLE_EQ(usage.queued_s, 1.0);
    EXPECT_DOUBLE_EQ(usage.waiting_s + usage.starved_s, 0.0);
}

TEST_F(NodeTimesTest, WhatRunsIsCountedBeforeItEnds) {
    times.arrived(GraphNode::kSolve, 1, start);
    times.begin(GraphNode::kSolve, start);
    EXPECT_DOUBLE_EQ(solve_at(3s).busy_s, 3.0);
    EXPECT_DOUBLE_EQ(solve_at(7s).busy_s, 7.0);
}

TEST_F(NodeTimesTest, MomentsInTheWrongOrderLoseNothing) {
    times.arrived(GraphNode::kSolve, 1, start + 4s);
    times.arrived(GraphNode::kSolve, 1, start + 3s);  // the other thread took the lock first
    const NodeUsage usage = solve_at(6s);
    EXPECT_DOUBLE_EQ(usage.starved_s, 4.0);
    EXPECT_DOUBLE_EQ(usage.waiting_s, 2.0);
    EXPECT_DOUBLE_EQ(usage.queued_s, 4.0);
}

TEST(NodeTimes, CountsRunsOfManyThreads) {
    NodeTimes times;
    constexpr int kThreads = 4;
    constexpr int kRuns = 2000;
    std::vector<std::thread> threads;
    for (int i = 0; i < kThreads; ++i) {
        threads.emplace_back([&times] {
            for (int run = 0; run < kRuns; ++run) {
                times.arrived(GraphNode::kVerify);
                const NodeTimes::Run timed(times, GraphNode::kVerify);
            }
        });
    }
    for (std::thread& thread : threads) thread.join();
    const GraphUsage usage = times.usage();
    const NodeUsage& verify = usage.nodes[static_cast<std::size_t>(GraphNode::kVerify)];
    EXPECT_EQ(verify.runs, static_cast<std::uint64_t>(kThreads * kRuns));
    EXPECT_NEAR(verify.busy_s + verify.waiting_s + verify.starved_s, usage.seconds,
                1e-6 * usage.seconds);
    EXPECT_LE(verify.work_s, kThreads * usage.seconds);
    EXPECT_GE(verify.work_s, verify.busy_s);
}

TEST(InOrder, LetsThroughWhatASequencerDoes) {
    InOrder in_order;
    EXPECT_EQ(in_order.arrived(1), 0U);
    EXPECT_EQ(in_order.arrived(2), 0U);
    EXPECT_EQ(in_order.arrived(0), 3U);
    EXPECT_EQ(in_order.arrived(4), 0U);
    EXPECT_EQ(in_order.arrived(3), 2U);
}

}  // namespace
}  // namespace psfm
