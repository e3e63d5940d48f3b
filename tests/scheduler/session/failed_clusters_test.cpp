// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Clusters whose solves fail.
#include <gtest/gtest.h>

#include <vector>

#include "scheduler/session/cluster_table.h"
#include "tests/scheduler/session/made_up_clusters.h"

namespace psfm {
namespace {

using namespace test;

TEST(FailedClusters, KeepAllMaterialForTheNextSolve) {
    ClusterTable table(kMuMin);
    table.apply(members(0, {0, 1, 2}));
    table.apply(members(1, {3, 4, 5}));
    solve_dirty(table);
    table.apply(join(1, images({3, 4, 5}), 0, {0, 1, 2, 3, 4, 5}));
    const auto dirty = table.take_dirty();
    ASSERT_EQ(dirty.size(), 1U);
    const ClusterEntry before = *dirty.front();
    table.fail(solve_of(before, {}).problem, Error{ErrorCode::kInternal, "no memory"});
    const ClusterEntry& entry = table.entries().at(cluster(0));
    EXPECT_FALSE(table.busy()) << "it is not tried again and again";
    EXPECT_TRUE(table.take_unsettled().empty());
    EXPECT_FALSE(is_solved(entry));
    EXPECT_EQ(entry.published.model, before.published.model) << "what was there is shown";
    EXPECT_EQ(entry.published.revision, before.published.revision);
    EXPECT_LT(entry.published.topology, entry.membership.topology) << "dirty where it is restored";
    EXPECT_EQ(entry.material.brought, before.material.brought) << "to be stored";
    table.apply(members(0, {0, 1, 2, 3, 4, 5, 6}));
    EXPECT_EQ(material_of(*table.take_dirty().front()),
              (Models{images({0, 1, 2}), images({3, 4, 5})}));
}

TEST(FailedClusters, ThatHaveChangedMeanwhileAreSolvedAgain) {
    ClusterTable table(kMuMin);
    table.apply(members(0, {0, 1, 2}));
    table.apply(members(1, {4, 5, 6}));
    std::vector<Solve> solves;
    for (const ClusterEntry* entry : table.take_dirty()) solves.push_back(solve_of(*entry, {}));
    table.apply(members(0, {0, 1, 2, 3}));
    table.apply(members(1, {4, 5}));
    for (const Solve& solve : solves) table.fail(solve.problem, Error{});
    ClusterProblem of_none;
    of_none.cluster = cluster(7);
    table.fail(of_none, Error{});
    const auto dirty = table.take_dirty();
    ASSERT_EQ(dirty.size(), 1U);
    EXPECT_EQ(dirty.front()->id, cluster(0));
    EXPECT_FALSE(dirty.front()->failure);
    EXPECT_TRUE(is_solved(table.entries().at(cluster(1)))) << "too small by now";
}

TEST(FailedClusters, ThatCannotSettleTryAgainOnceTheyHaveChanged) {
    ClusterTable table(kMuMin);
    table.apply(members(0, {0, 1, 2}));
    solve_dirty(table);
    const ClusterEntry before = *table.take_unsettled().front();
    table.fail(solve_of(before, {}, true).problem, Error{ErrorCode::kInternal, "no memory"});
    const ClusterEntry& entry = table.entries().at(cluster(0));
    EXPECT_FALSE(entry.published.settled);
    EXPECT_EQ(entry.published.model, before.published.model);
    EXPECT_EQ(entry.published.revision, before.published.revision);
    EXPECT_TRUE(is_solved(entry)) << "its images have what they had";
    EXPECT_FALSE(table.busy());
    EXPECT_TRUE(table.take_unsettled().empty()) << "not again and again";
    table.apply(members(0, {0, 1, 2, 3}));
    solve_dirty(table);
    EXPECT_EQ(table.take_unsettled().size(), 1U);
}

}  // namespace
}  // namespace psfm
