// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <vector>

#include "stages/clustering/update_clustering.h"
#include "tests/stages/clustering/random_graphs.h"

namespace psfm {
namespace {

using test::connect;
using test::WeightTable;

std::vector<ImageId> images(std::initializer_list<std::uint32_t> numbers) {
    std::vector<ImageId> ids;
    for (const std::uint32_t number : numbers) ids.push_back(static_cast<ImageId>(number));
    return ids;
}

ClusterId cluster(std::uint32_t number) {
    return static_cast<ClusterId>(number);
}

std::vector<ImageId> all_of(const WeightTable& table) {
    std::vector<ImageId> ids;
    for (std::uint32_t i = 0; i < table.size; ++i) ids.push_back(static_cast<ImageId>(i));
    return ids;
}

TEST(ClusterIds, ANewImageAloneIsACluster) {
    ViewGraph graph;
    graph.add_node();
    ClusteringState state;
    const ClusteringEdit edit = update_clustering(state, graph, {}, {});
    const ClusteringEdit expected{
        .changed = {{cluster(0), images({0})}}, .removed = {}, .moved = {}};
    EXPECT_EQ(edit, expected);
    EXPECT_EQ(state.next_id, cluster(1));
}

TEST(ClusterIds, ANewImageJoinsWithoutMoving) {
    WeightTable table(3);
    connect(table, 0, 2, 50.0);
    const std::vector<std::size_t> order{0, 1, 2};
    ViewGraph graph;
    ClusteringState state;
    ClusteringEdit edit;
    for (int k = 0; k < 3; ++k) {
        edit = update_clustering(state, graph, test::add_next(graph, table, order), {});
    }
    const ClusteringEdit expected{
        .changed = {{cluster(0), images({0, 1, 2})}}, .removed = {}, .moved = {}};
    EXPECT_EQ(edit, expected);
}

TEST(ClusterIds, TheLargestClustersIdSurvivesAJoin) {
    WeightTable table(5);
    connect(table, 0, 1, 50.0);
    connect(table, 2, 4, 50.0);
    ClusteringState state;
    update_clustering(state, test::graph_of(table), {}, {});
    ASSERT_EQ(state.members.size(), 2U);
    connect(table, 0, 4, 50.0);
    const ClusteringEdit edit = update_clustering(state, test::graph_of(table), all_of(table), {});
    const ClusteringEdit expected{.changed = {{cluster(1), images({0, 1, 2, 3, 4})}},
                                  .removed = {cluster(0)},
                                  .moved = {{cluster(0), cluster(1), images({0, 1})}}};
    EXPECT_EQ(edit, expected);
}

TEST(ClusterIds, EqualClustersJoinUnderTheSmallerId) {
    WeightTable table(4);
    connect(table, 0, 1, 50.0);
    connect(table, 2, 3, 50.0);
    ClusteringState state;
    update_clustering(state, test::graph_of(table), {}, {});
    connect(table, 0, 3, 50.0);
    const ClusteringEdit edit = update_clustering(state, test::graph_of(table), all_of(table), {});
    EXPECT_EQ(edit.removed, std::vector<ClusterId>{cluster(1)});
    EXPECT_EQ(edit.moved.front().members, images({2, 3}));
}

TEST(ClusterIds, TheLargestPartKeepsTheIdOfASplitCluster) {
    WeightTable table(7);
    connect(table, 0, 6, 50.0);
    ClusteringState state;
    update_clustering(state, test::graph_of(table), {}, {});
    ASSERT_EQ(state.members.size(), 1U);
    table = WeightTable(7);
    connect(table, 0, 1, 50.0);
    connect(table, 2, 4, 50.0);
    connect(table, 5, 6, 50.0);
    const ClusteringEdit edit = update_clustering(state, test::graph_of(table), all_of(table), {});
    const ClusteringEdit expected{.changed = {{cluster(0), images({2, 3, 4})},
                                              {cluster(1), images({0, 1})},
                                              {cluster(2), images({5, 6})}},
                                  .removed = {},
                                  .moved = {{cluster(0), cluster(1), images({0, 1})},
                                            {cluster(0), cluster(2), images({5, 6})}}};
    EXPECT_EQ(edit, expected);
    EXPECT_EQ(state.next_id, cluster(3));
}

TEST(ClusterIds, OfEqualPartsTheOneWithTheSmallestImageKeepsTheId) {
    WeightTable table(4);
    connect(table, 0, 3, 50.0);
    ClusteringState state;
    update_clustering(state, test::graph_of(table), {}, {});
    table = WeightTable(4);
    table.set(0, 2, 50.0);
    table.set(1, 3, 50.0);
    const ClusteringEdit edit = update_clustering(state, test::graph_of(table), all_of(table), {});
    const ClusteringEdit expected{
        .changed = {{cluster(0), images({0, 2})}, {cluster(1), images({1, 3})}},
        .removed = {},
        .moved = {{cluster(0), cluster(1), images({1, 3})}}};
    EXPECT_EQ(edit, expected);
}

TEST(ClusterIds, APartThatMovesToAnotherClusterIsOneGroup) {
    WeightTable table(8);
    connect(table, 0, 4, 50.0);
    connect(table, 5, 7, 50.0);
    ClusteringState state;
    update_clustering(state, test::graph_of(table), {}, {});
    table = WeightTable(8);
    connect(table, 0, 2, 50.0);
    connect(table, 3, 7, 50.0);
    const ClusteringEdit edit = update_clustering(state, test::graph_of(table), all_of(table), {});
    const ClusteringEdit expected{
        .changed = {{cluster(0), images({0, 1, 2})}, {cluster(1), images({3, 4, 5, 6, 7})}},
        .removed = {},
        .moved = {{cluster(0), cluster(1), images({3, 4})}}};
    EXPECT_EQ(edit, expected);
}

}  // namespace
}  // namespace psfm
