// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/session/cluster_table.h"

#include <gtest/gtest.h>

#include "tests/scheduler/session/made_up_clusters.h"

namespace psfm {
namespace {

using namespace test;

TEST(ClusterTable, SolvesADirtyClusterOnce) {
    ClusterTable table(kMuMin);
    table.apply(members(0, {0, 1, 2}));
    const auto dirty = table.take_dirty();
    ASSERT_EQ(dirty.size(), 1U);
    EXPECT_TRUE(table.take_dirty().empty()) << "one solve in flight per cluster";
    EXPECT_TRUE(table.busy());
    Solve solve = solve_of(*dirty.front(), images({0, 1, 2}));
    const ClusterEntry* published = table.finish(solve.problem, solve.solution);
    ASSERT_NE(published, nullptr);
    EXPECT_EQ(published->published.revision, 1U);
    EXPECT_FALSE(table.busy());
    EXPECT_TRUE(table.take_dirty().empty()) << "a clean cluster is never solved";
}

TEST(ClusterTable, SmallClustersAreCleanAtOnce) {
    ClusterTable table(kMuMin);
    table.apply(members(0, {0, 1}));
    EXPECT_FALSE(table.busy());
    EXPECT_TRUE(table.take_dirty().empty());
}

TEST(ClusterTable, AResultForAnOutdatedTopologyBecomesMaterial) {
    ClusterTable table(kMuMin);
    table.apply(members(0, {0, 1, 2}));
    const ClusterEntry before = *table.take_dirty().front();
    table.apply(members(0, {0, 1, 2, 3}));
    EXPECT_TRUE(table.take_dirty().empty()) << "its solve is still in flight";
    Solve solve = solve_of(before, images({0, 1, 2}));
    EXPECT_EQ(table.finish(solve.problem, solve.solution), nullptr) << "never published as current";
    EXPECT_EQ(table.coalesced(), 1U);
    const auto again = table.take_dirty();
    ASSERT_EQ(again.size(), 1U);
    EXPECT_EQ(material_of(*again.front()), Models{images({0, 1, 2})}) << "never thrown away";
    EXPECT_EQ(again.front()->published.model, nullptr);
}

/// What was not published is not stored either: what is stored next says what changed since that.
TEST(ClusterTable, ASuccessionLeadsFromThePublishedModelOverOutgrownResults) {
    ClusterTable table(kMuMin);
    table.apply(members(0, {0, 1, 2}));
    Solve first = solve_of(*table.take_dirty().front(), images({0, 1, 2}));
    const auto published = first.solution.model;
    table.finish(first.problem, first.solution);
    std::shared_ptr<const Reconstruction> last = published;
    const auto grow = [&](std::initializer_list<std::uint32_t> now, bool is_outgrown,
                          std::initializer_list<std::uint32_t> then,
                          std::vector<std::uint8_t> replaced) {
        const ClusterEntry taken = *table.take_dirty().front();
        Solve solve = solve_of(taken, images(now));
        solve.solution.succession = Succession{last, std::move(replaced)};
        if (is_outgrown) table.apply(members(0, then));
        EXPECT_EQ(table.finish(solve.problem, solve.solution) == nullptr, is_outgrown);
        last = solve.solution.model;
        return solve.solution.succession;
    };
    table.apply(members(0, {0, 1, 2, 3}));
    grow({0, 1, 2, 3}, true, {0, 1, 2, 3, 4}, {0, 0, 1});
    grow({0, 1, 2, 3, 4}, true, {0, 1, 2, 3, 4, 5}, {0, 0, 0, 1});
    const auto since = grow({0, 1, 2, 3, 4, 5}, false, {}, {0, 1, 0});
    ASSERT_TRUE(since);
    EXPECT_EQ(since->before, published);
    EXPECT_EQ(since->replaced, (std::vector<std::uint8_t>{0, 1, 1}));

    const auto now_published = last;
    table.apply(members(0, {0, 1, 2, 3, 4, 5, 6}));
    const auto next = grow({0, 1, 2, 3, 4, 5, 6}, false, {}, {1});
    ASSERT_TRUE(next);
    EXPECT_EQ(next->before, now_published) << "what was outgrown is forgotten";
    EXPECT_EQ(next->replaced, std::vector<std::uint8_t>{1});
}

TEST(ClusterTable, AnOutgrownResultWithoutSuccessionEndsIt) {
    ClusterTable table(kMuMin);
    table.apply(members(0, {0, 1, 2}));
    Solve first = solve_of(*table.take_dirty().front(), images({0, 1, 2}));
    table.finish(first.problem, first.solution);
    table.apply(members(0, {0, 1, 2, 3}));
    Solve whole = solve_of(*table.take_dirty().front(), images({0, 1, 2, 3}));
    table.apply(members(0, {0, 1, 2, 3, 4}));
    EXPECT_EQ(table.finish(whole.problem, whole.solution), nullptr);
    Solve local = solve_of(*table.take_dirty().front(), images({0, 1, 2, 3, 4}));
    local.solution.succession = Succession{whole.solution.model, {0, 1}};
    ASSERT_NE(table.finish(local.problem, local.solution), nullptr);
    EXPECT_EQ(local.solution.succession->before, whole.solution.model)
        << "it is not a change to the published one";
}

TEST(ClusterTable, GrowingExtendsTheModel) {
    ClusterTable table(kMuMin);
    table.apply(members(0, {0, 1, 2}));
    Solve solve = solve_of(*table.take_dirty().front(), images({0, 1, 2}));
    table.finish(solve.problem, solve.solution);
    EXPECT_TRUE(table.apply(members(0, {0, 1, 2, 3})).empty());
    const auto dirty = table.take_dirty();
    ASSERT_EQ(dirty.size(), 1U);
    EXPECT_EQ(material_of(*dirty.front()), Models{images({0, 1, 2})});
}

TEST(ClusterTable, JoinedModelsAreBothMaterial) {
    ClusterTable table(kMuMin);
    table.apply(members(0, {0, 1, 2}));
    table.apply(members(1, {3, 4, 5}));
    for (const ClusterEntry* entry : table.take_dirty()) {
        Solve solve = solve_of(*entry, entry->membership.members);
        table.finish(solve.problem, solve.solution);
    }
    const auto changes = table.apply(join(1, images({3, 4, 5}), 0, {0, 1, 2, 3, 4, 5, 6}));
    ASSERT_EQ(changes.size(), 2U);
    EXPECT_EQ(changes.front().kind, ClusterChange::Kind::kTransfer);
    EXPECT_EQ(changes.front().images, 3U);
    EXPECT_EQ(changes.back().kind, ClusterChange::Kind::kJoin);
    EXPECT_EQ(changes.back().others, std::vector{cluster(1)});
    const auto dirty = table.take_dirty();
    ASSERT_EQ(dirty.size(), 1U);
    EXPECT_EQ(material_of(*dirty.front()), (Models{images({0, 1, 2}), images({3, 4, 5})}));
    EXPECT_EQ(dirty.front()->material.models.back().cluster, cluster(1))
        << "so that it can be stored";
    EXPECT_EQ(dirty.front()->material.models.back().revision, 1U);
    EXPECT_NE(dirty.front()->published.model, nullptr)
        << "what was published stays until the new model is there";
    EXPECT_EQ(table.entries().size(), 1U);
    EXPECT_EQ(table.of(image(4)).id, cluster(0));
}

TEST(ClusterTable, ASplitModelIsCutAndBothPartsKeepTheirs) {
    ClusterTable table(kMuMin);
    table.apply(members(0, {0, 1, 2, 3, 4, 5}));
    solve_dirty(table);
    ClusteringEdit split;
    split.changed = {{cluster(0), images({0, 1, 2})}, {cluster(1), images({3, 4, 5})}};
    split.moved.push_back({cluster(0), cluster(1), images({3, 4, 5})});
    const auto changes = table.apply(split);
    ASSERT_EQ(changes.size(), 2U);
    EXPECT_EQ(changes[0].kind, ClusterChange::Kind::kSplit);
    EXPECT_EQ(changes[1].kind, ClusterChange::Kind::kTransfer);
    const auto dirty = table.take_dirty();
    ASSERT_EQ(dirty.size(), 2U);
    EXPECT_EQ(material_of(*dirty[0]), Models{images({0, 1, 2})});
    EXPECT_EQ(material_of(*dirty[1]), Models{images({3, 4, 5})});
    ASSERT_NE(dirty[0]->published.model, nullptr) << "what stays is shown on";
    EXPECT_EQ(images_in(*dirty[0]->published.model), images({0, 1, 2}))
        << "no image stands in two models";
    EXPECT_EQ(dirty[0]->published.revision, 1U) << "of the solution that it is a part of";
    EXPECT_EQ(dirty[1]->published.model, nullptr);
}

TEST(ClusterTable, AModelThatIsCutBelowMuMinIsShownNoMore) {
    ClusterTable table(kMuMin);
    table.apply(members(0, {0, 1, 2, 3, 4}));
    solve_dirty(table);
    ClusteringEdit split;
    split.changed = {{cluster(0), images({0, 1, 5})}, {cluster(1), images({2, 3, 4})}};
    split.moved.push_back({cluster(0), cluster(1), images({2, 3, 4})});
    table.apply(split);
    EXPECT_EQ(table.entries().at(cluster(0)).published.model, nullptr);
}

TEST(ClusterTable, AClusterBelowMuMinStartsAnewWhenItGrowsAgain) {
    ClusterTable table(kMuMin);
    table.apply(members(0, {0, 1, 2, 3}));
    for (const ClusterEntry* entry : table.take_dirty()) {
        Solve solve = solve_of(*entry, images({0, 1, 2, 3}));
        solve.solution.state.images_at_start = 4;
        table.finish(solve.problem, solve.solution);
    }
    table.apply(members(0, {0, 1}));
    EXPECT_TRUE(material_of(table.entries().at(cluster(0))).empty());
    table.apply(members(0, {0, 1, 2, 3}));
    const auto dirty = table.take_dirty();
    ASSERT_EQ(dirty.size(), 1U);
    EXPECT_TRUE(material_of(*dirty.front()).empty());
    EXPECT_EQ(dirty.front()->material.state, SolveState{});
    EXPECT_EQ(dirty.front()->published.revision, 1U) << "the next solution is the second";
}

TEST(ClusterTable, WhatASolveGaveUpIsNotStartedFromAgain) {
    ClusterTable table(kMuMin);
    table.apply(members(0, {0, 1, 2}));
    solve_dirty(table);
    table.apply(members(0, {0, 1, 2, 3}));
    for (const ClusterEntry* entry : table.take_dirty()) {
        Solve nothing = solve_of(*entry, {});
        EXPECT_NE(table.finish(nothing.problem, nothing.solution), nullptr);
    }
    EXPECT_TRUE(material_of(table.entries().at(cluster(0))).empty());
}

TEST(ClusterTable, AGroupBelowMuMinBringsNoModel) {
    ClusterTable table(kMuMin);
    table.apply(members(0, {0, 1, 2, 3, 4}));
    table.apply(members(1, {5, 6, 7}));
    solve_dirty(table);
    ClusteringEdit move;
    move.changed = {{cluster(0), images({0, 1, 2})}, {cluster(1), images({3, 4, 5, 6, 7})}};
    move.moved.push_back({cluster(0), cluster(1), images({3, 4})});
    table.apply(move);
    const auto dirty = table.take_dirty();
    ASSERT_EQ(dirty.size(), 2U);
    EXPECT_EQ(material_of(*dirty[1]), Models{images({5, 6, 7})});
}

TEST(ClusterTable, PartsOfSeveralEditsComeTogether) {
    ClusterTable table(kMuMin);
    table.apply(members(0, {0, 1, 2}));
    table.apply(members(1, {3, 4, 5}));
    table.apply(members(2, {6, 7, 8}));
    solve_dirty(table);
    table.apply(join(1, images({3, 4, 5}), 0, {0, 1, 2, 3, 4, 5}));
    table.apply(join(0, images({0, 1, 2, 3, 4, 5}), 2, {0, 1, 2, 3, 4, 5, 6, 7, 8}));
    const auto dirty = table.take_dirty();
    ASSERT_EQ(dirty.size(), 1U);
    EXPECT_EQ(material_of(*dirty.front()),
              (Models{images({6, 7, 8}), images({0, 1, 2}), images({3, 4, 5})}));
}

TEST(ClusterTable, AResultThatIsGivenUpLeavesNoTrace) {
    ClusterTable table(kMuMin);
    table.apply(members(0, {0, 1, 2}));
    table.apply(members(1, {4, 5, 6}));
    solve_dirty(table);
    table.apply(members(0, {0, 1, 2, 3}));
    table.apply(members(1, {4, 5, 6, 7}));
    ASSERT_EQ(table.take_dirty().size(), 2U);
    table.apply(members(1, {4, 5}));
    for (const std::uint32_t id : {0U, 1U, 2U}) table.give_up(cluster(id));
    EXPECT_EQ(table.coalesced(), 3U) << "one of a cluster that is gone, too";
    EXPECT_EQ(table.entries().at(cluster(1)).phase, ClusterPhase::kClean) << "too small by now";
    EXPECT_EQ(table.entries().at(cluster(1)).published.model, nullptr);
    const auto dirty = table.take_dirty();
    ASSERT_EQ(dirty.size(), 1U);
    EXPECT_EQ(dirty.front()->membership.topology, 2U) << "nothing changed but by the edit";
    EXPECT_EQ(dirty.front()->published.revision, 1U);
    EXPECT_EQ(material_of(*dirty.front()), Models{images({0, 1, 2})});
}

TEST(ClusterTable, ALostEdgeMakesACleanClusterDirty) {
    ClusterTable table(kMuMin);
    table.apply(members(0, {0, 1, 2}));
    solve_dirty(table);
    EXPECT_FALSE(table.busy());
    table.make_dirty(std::vector{cluster(0)});
    const auto dirty = table.take_dirty();
    ASSERT_EQ(dirty.size(), 1U);
    EXPECT_EQ(dirty.front()->membership.topology, 2U);
    EXPECT_EQ(material_of(*dirty.front()), Models{images({0, 1, 2})});
}

TEST(ClusterTable, ResultsFromBeforeAJoinAreJoinedWithWhatCame) {
    ClusterTable table(kMuMin);
    table.apply(members(0, {0, 1, 2}));
    table.apply(members(1, {3, 4, 5}));
    std::vector<ClusterEntry> first;
    for (const ClusterEntry* entry : table.take_dirty()) first.push_back(*entry);
    Solve one = solve_of(first[1], images({3, 4, 5}));
    table.finish(one.problem, one.solution);
    table.apply(join(1, images({3, 4, 5}), 0, {0, 1, 2, 3, 4, 5}));
    Solve outdated = solve_of(first[0], images({0, 1, 2}));
    EXPECT_EQ(table.finish(outdated.problem, outdated.solution), nullptr);
    const auto dirty = table.take_dirty();
    ASSERT_EQ(dirty.size(), 1U);
    EXPECT_EQ(material_of(*dirty.front()), (Models{images({0, 1, 2}), images({3, 4, 5})}));
}

/// Joining large models takes long, and more of them come meanwhile: what is joined stays so.
TEST(ClusterTable, AJoinThatAnotherOneOvertakesIsNotDoneAgain) {
    ClusterTable table(kMuMin);
    table.apply(members(0, {0, 1, 2}));
    table.apply(members(1, {3, 4, 5}));
    table.apply(members(2, {6, 7, 8}));
    solve_dirty(table);
    table.apply(join(1, images({3, 4, 5}), 0, {0, 1, 2, 3, 4, 5}));
    Solve solve = solve_of(*table.take_dirty().front(), images({0, 1, 2, 3, 4, 5}));
    table.apply(join(2, images({6, 7, 8}), 0, {0, 1, 2, 3, 4, 5, 6, 7, 8}));
    EXPECT_EQ(table.finish(solve.problem, solve.solution), nullptr);
    const auto dirty = table.take_dirty();
    ASSERT_EQ(dirty.size(), 1U);
    EXPECT_EQ(material_of(*dirty.front()), (Models{images({0, 1, 2, 3, 4, 5}), images({6, 7, 8})}));
    // Nothing of the join is stored yet: a process that dies now leaves all three to the next.
    const std::vector<std::pair<ClusterId, std::uint32_t>> both = {{cluster(1), 1U},
                                                                   {cluster(2), 1U}};
    EXPECT_EQ(dirty.front()->material.brought, both);
    Solve last = solve_of(*dirty.front(), images({0, 1, 2, 3, 4, 5, 6, 7, 8}));
    const ClusterEntry* published = table.finish(last.problem, last.solution);
    ASSERT_NE(published, nullptr);
    EXPECT_EQ(material_of(*published), Models{images({0, 1, 2, 3, 4, 5, 6, 7, 8})});
    EXPECT_TRUE(published->material.brought.empty());
}

TEST(ClusterTable, ResultsOfRemovedClustersAreDropped) {
    ClusterTable table(kMuMin);
    table.apply(members(0, {0, 1, 2}));
    Solve solve = solve_of(*table.take_dirty().front(), images({0, 1, 2}));
    ClusteringEdit edit = members(1, {0, 1, 2, 3});
    edit.removed = {cluster(0)};
    table.apply(edit);
    EXPECT_EQ(table.finish(solve.problem, solve.solution), nullptr);
    EXPECT_EQ(table.take_dirty().size(), 1U);
}

TEST(ClusterTable, RestoresDirtyAndCleanClusters) {
    ClusterEntry clean;
    clean.id = cluster(0);
    clean.membership.members = images({0, 1, 2});
    clean.membership.topology = clean.published.topology = 4;
    ClusterEntry dirty = clean;
    dirty.id = cluster(1);
    dirty.membership.members = images({3, 4, 5});
    dirty.membership.topology = 5;
    ClusterTable table(kMuMin, {clean, dirty}, hosts_of({clean, dirty}));
    const auto taken = table.take_dirty();
    ASSERT_EQ(taken.size(), 1U);
    EXPECT_EQ(taken.front()->id, cluster(1));
    EXPECT_EQ(table.hosts().image_count(), 6U);
}

TEST(ClusterTable, CleanClustersRestWhenTheyAreRestored) {
    for (const bool is_dirty : {false, true}) {
        ClusterEntry entry;
        entry.id = cluster(0);
        entry.membership = {.members = images({0, 1, 2}), .topology = 4};
        entry.published.topology = is_dirty ? 3 : 4;
        entry.published.revision = 1;
        ClusterTable table(kMuMin, {entry}, hosts_of({entry}));
        entry.published.model = solve_of(entry, entry.membership.members).solution.model;
        entry.material.models = {{entry.id, entry.published.revision, entry.published.model}};
        entry.published.cameras = std::make_shared<const ModelCameras>();
        table.restore_models(entry);
        EXPECT_EQ(table.entries().at(cluster(0)).published.rests, !is_dirty);
        EXPECT_EQ(material_of(table.entries().at(cluster(0))), Models{images({0, 1, 2})});
        EXPECT_EQ(table.take_dirty().size(), is_dirty ? 1U : 0U);
    }
}

TEST(ClusterTable, WhatAMergeFoundIsOfTheModelThatItHad) {
    ClusterTable table(kMuMin);
    table.apply(members(0, {0, 1, 2}));
    solve_dirty(table);
    const ClusterEntry& entry = table.entries().at(cluster(0));
    const auto merged = entry.published.model;
    const auto cameras = std::make_shared<const ModelCameras>();
    EXPECT_FALSE(may_rest(entry)) << "not merged yet";
    table.learn_cameras(cluster(0), merged, cameras);
    EXPECT_EQ(entry.published.cameras, cameras);
    EXPECT_TRUE(may_rest(entry));
    table.apply(members(0, {0, 1, 2, 3}));
    EXPECT_FALSE(may_rest(entry));
    solve_dirty(table);
    EXPECT_EQ(entry.published.cameras, nullptr);
    table.learn_cameras(cluster(0), merged, cameras);
    EXPECT_EQ(entry.published.cameras, nullptr) << "of the model before";
    table.learn_cameras(cluster(7), merged, cameras);
}

}  // namespace
}  // namespace psfm
