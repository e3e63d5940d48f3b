// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Groups that are too small by themselves join what they share most with once no image follows.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <vector>

#include "stages/clustering/batch_clusters.h"
#include "stages/clustering/clustering_state.h"
#include "stages/clustering/rescue_links.h"
#include "stages/clustering/update_clustering.h"
#include "tests/stages/clustering/check_edit.h"
#include "tests/stages/clustering/random_graphs.h"

namespace psfm {
namespace {

using test::connect;
using test::WeightTable;

std::vector<std::vector<ImageId>> partition(const ClusteringState& state) {
    std::vector<std::vector<ImageId>> parts;
    for (const auto& [id, members] : state.members) parts.push_back(members);
    std::ranges::sort(parts);
    return parts;
}

/// Whether an edge of the graph leads out of some images.
bool has_way_out(const ViewGraph& graph, const std::vector<ImageId>& images) {
    return std::ranges::any_of(images, [&](ImageId image) {
        return std::ranges::any_of(graph.edges(image), [&](const ViewGraph::Edge& edge) {
            return !std::ranges::binary_search(images, edge.neighbor);
        });
    });
}

TEST(JoinLate, EndsInTheClustersOfABatchInEveryOrder) {
    synthetic::Rng rng(31);
    std::size_t joined = 0;
    for (int round = 0; round < 1000; ++round) {
        SCOPED_TRACE(round);
        const WeightTable table = test::random_weights(rng);
        const ClusteringOptions options{.eta = rng.below(2) == 0 ? 0.2 : 0.05,
                                        .join_below = static_cast<std::uint32_t>(2 + rng.below(8))};
        const std::vector<std::size_t> order = synthetic::random_order(table.size, rng.bits());
        ViewGraph graph;
        ClusteringState state;
        for (std::size_t k = 0; k < table.size; ++k) {
            const auto touched = test::add_next(graph, table, order);
            const auto before = state.members;
            const ClusteringEdit edit = update_clustering(state, graph, touched, options);
            ASSERT_NO_FATAL_FAILURE(test::expect_edit_tells_all(before, state, edit, k));
            if (rng.below(4) == 0) join_late(state, graph, options);  // the stream has paused
        }
        const auto before = state.members;
        joined += before.size();
        const ClusteringEdit edit = join_late(state, graph, options);
        ASSERT_NO_FATAL_FAILURE(test::expect_edit_tells_all(before, state, edit, table.size));
        ASSERT_EQ(partition(state), batch_clusters(graph, options));
        ASSERT_EQ(join_late(state, graph, options), ClusteringEdit{});
        joined -= state.members.size();
        for (const auto& [id, members] : state.members) {
            ASSERT_TRUE(members.size() >= options.join_below || !has_way_out(graph, members))
                << "an edge could have joined it to something";
        }
        const auto restored = restore_clustering(graph, clusters_of(state), state.next_id, options);
        ASSERT_TRUE(restored.ok()) << restored.error().message;
        ASSERT_EQ(partition(*restored), partition(state));
    }
    EXPECT_GT(joined, 300U) << "hardly anything was too small";
}

TEST(JoinLate, WeakEdgesJoinOnlyWhatNothingElseDoes) {
    // A group of six; an image that a weak edge alone connects with it; two more that share a
    // stronger edge with one another, and a weak one with the first.
    WeightTable table(9);
    connect(table, 0, 5, 50.0);
    table.set(7, 8, 20.0);
    ViewGraph graph = test::graph_of(table);
    graph.add_edge(static_cast<ImageId>(5), static_cast<ImageId>(6), 0.0);
    graph.add_edge(static_cast<ImageId>(6), static_cast<ImageId>(7), 0.0);
    const ClusteringOptions options{.join_below = 5};
    ClusteringState state;
    update_clustering(state, graph, {}, options);
    EXPECT_EQ(state.cluster_of[7], state.cluster_of[8]);
    EXPECT_NE(state.cluster_of[6], state.cluster_of[5]) << "a weak edge is near nothing";
    EXPECT_NE(state.cluster_of[6], state.cluster_of[7]);
    join_late(state, graph, options);
    EXPECT_EQ(state.members.size(), 1U);
    // A better edge comes: what was joined late comes apart as that says.
    graph.remove_edge(static_cast<ImageId>(5), static_cast<ImageId>(6));
    const std::vector<ImageId> touched{static_cast<ImageId>(5), static_cast<ImageId>(6)};
    update_clustering(state, graph, touched, options);
    EXPECT_NE(state.cluster_of[6], state.cluster_of[5]);
    EXPECT_EQ(state.cluster_of[6], state.cluster_of[7]);
}

TEST(JoinLate, LargeGroupsStayApart) {
    WeightTable table(12);
    connect(table, 0, 5, 50.0);
    connect(table, 6, 11, 50.0);
    table.set(5, 6, 3.0);
    const ViewGraph graph = test::graph_of(table);
    ClusteringState state;
    update_clustering(state, graph, {}, {.join_below = 6});
    EXPECT_EQ(join_late(state, graph, {.join_below = 6}), ClusteringEdit{});
    EXPECT_EQ(state.members.size(), 2U);
    EXPECT_EQ(join_late(state, graph, {.join_below = 7}).changed.size(), 1U);
}

TEST(JoinLate, AGroupThatMakesAModelAndWasShownToBeApartStaysByItself) {
    WeightTable table(15);
    connect(table, 0, 5, 50.0);
    connect(table, 6, 10, 50.0);
    connect(table, 11, 14, 50.0);
    table.set(5, 6, 3.0);
    table.set(5, 11, 3.0);
    const ViewGraph graph = test::graph_of(table);
    const ClusteringOptions options{.join_below = 6};
    std::vector<std::vector<ImageId>> apart(15);
    for (const std::size_t image : {7U, 12U}) apart[image] = {static_cast<ImageId>(0)};
    ClusteringState state;
    update_clustering(state, graph, {}, options);
    ASSERT_EQ(state.members.size(), 3U);
    join_late(state, graph, options, {apart, 5});
    EXPECT_EQ(state.members.size(), 2U);
    EXPECT_NE(state.cluster_of[7], state.cluster_of[0]) << "five make a model";
    EXPECT_EQ(state.cluster_of[12], state.cluster_of[0]) << "four do not";
    join_late(state, graph, options);
    EXPECT_EQ(state.members.size(), 1U) << "nothing is apart any more";
}

TEST(SmallGroup, EndsAtTheSizeAskedFor) {
    const NearNeighbors near{{static_cast<ImageId>(1)},
                             {static_cast<ImageId>(0), static_cast<ImageId>(2)},
                             {static_cast<ImageId>(1)},
                             {}};
    EXPECT_EQ(small_group(near, static_cast<ImageId>(0), 9).size(), 3U);
    EXPECT_EQ(small_group(near, static_cast<ImageId>(0), 2).size(), 2U);
    EXPECT_EQ(small_group(near, static_cast<ImageId>(3), 2).size(), 1U);
}

}  // namespace
}  // namespace psfm
