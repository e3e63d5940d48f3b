// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Clusters that settle, once or later.
#include <gtest/gtest.h>

#include "scheduler/session/cluster_table.h"
#include "tests/scheduler/session/made_up_clusters.h"

namespace psfm {
namespace {

using namespace test;

TEST(ClusterSettling, SettlesOnce) {
    ClusterTable table(kMuMin);
    table.apply(members(0, {0, 1, 2}));
    Solve solve = solve_of(*table.take_dirty().front(), images({0, 1, 2}));
    table.finish(solve.problem, solve.solution);
    const auto unsettled = table.take_unsettled();
    ASSERT_EQ(unsettled.size(), 1U);
    Solve settle = solve_of(*unsettled.front(), images({0, 1, 2}), true);
    table.finish(settle.problem, settle.solution);
    EXPECT_TRUE(table.take_unsettled().empty());
    table.apply(members(0, {0, 1, 2, 3}));
    EXPECT_EQ(table.take_dirty().size(), 1U);
}

TEST(ClusterSettling, WhatIsPutOffSettlesLater) {
    ClusterTable table(kMuMin);
    table.apply(members(0, {0, 1, 2}));
    table.apply(members(1, {4, 5, 6}));
    solve_dirty(table);
    ASSERT_EQ(table.take_unsettled().size(), 2U);
    for (const std::uint32_t id : {0U, 1U}) ASSERT_NE(table.begin_taken(cluster(id)), nullptr);
    table.apply(members(1, {4, 5, 6, 7}));
    for (const std::uint32_t id : {0U, 1U, 2U}) table.put_off(cluster(id));
    const auto dirty = table.take_dirty();
    ASSERT_EQ(dirty.size(), 1U) << "the one that changed is solved first";
    EXPECT_EQ(dirty.front()->id, cluster(1));
    const auto unsettled = table.take_unsettled();
    ASSERT_EQ(unsettled.size(), 1U);
    EXPECT_EQ(unsettled.front()->id, cluster(0));
    EXPECT_EQ(material_of(*unsettled.front()), Models{images({0, 1, 2})});
}

TEST(ClusterSettling, WhatChangesBeforeItSettlesIsSolvedFirst) {
    ClusterTable table(kMuMin);
    for (const std::uint32_t id : {0U, 1U}) {
        table.apply(members(id, {4 * id, 4 * id + 1, 4 * id + 2}));
        solve_dirty(table);
    }
    ASSERT_EQ(table.take_unsettled().size(), 2U);
    table.apply(members(1, {4, 5, 6, 7}));
    EXPECT_TRUE(table.take_dirty().empty()) << "it is taken";
    EXPECT_EQ(table.begin_taken(cluster(0)), &table.entries().at(cluster(0)));
    EXPECT_EQ(table.begin_taken(cluster(1)), nullptr);
    const auto dirty = table.take_dirty();
    ASSERT_EQ(dirty.size(), 1U);
    EXPECT_EQ(dirty.front()->id, cluster(1));
    EXPECT_EQ(table.begin_taken(cluster(9)), nullptr);
}

}  // namespace
}  // namespace psfm
