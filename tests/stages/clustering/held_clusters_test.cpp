// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Clusters that are held apart for their size, until join_late.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>
#include <vector>

#include "stages/clustering/batch_clusters.h"
#include "stages/clustering/update_clustering.h"
#include "tests/stages/clustering/check_edit.h"
#include "tests/stages/clustering/random_graphs.h"

namespace psfm {
namespace {

using test::connect;
using test::WeightTable;

/// @param hold_from  images from which a cluster does not join any other
ClusteringOptions options_with(std::uint32_t join_up_to, std::uint32_t hold_from,
                               double eta = 0.5) {
    ClusteringOptions options{.eta = eta, .join_below = 0, .join_up_to = join_up_to};
    if (join_up_to > 0) options.hold_part = static_cast<double>(hold_from) / join_up_to;
    return options;
}

std::vector<ImageId> images(std::uint32_t first, std::uint32_t last) {
    std::vector<ImageId> ids;
    for (std::uint32_t i = first; i <= last; ++i) ids.push_back(static_cast<ImageId>(i));
    return ids;
}

/// Two groups of six, whose last three match those of the other.
WeightTable two_groups() {
    WeightTable table(12);
    connect(table, 0, 5, 50.0);
    connect(table, 6, 11, 50.0);
    for (std::size_t a = 3; a <= 5; ++a) {
        for (std::size_t b = 9; b <= 11; ++b) table.set(a, b, 30.0);
    }
    return table;
}

/// Images arrive one by one, in the order of the table.
ClusteringState grown_in_order(const WeightTable& table, const ClusteringOptions& options) {
    std::vector<std::size_t> order(table.size);
    std::iota(order.begin(), order.end(), std::size_t{0});
    ViewGraph graph;
    ClusteringState state;
    while (graph.size() < table.size)
        update_clustering(state, graph, test::add_next(graph, table, order), options);
    return state;
}

/// Images that links join without leaving the cluster.
std::set<ImageId> reached_from(const ClusteringState& state, ImageId start) {
    std::set<ImageId> reached{start};
    std::vector<ImageId> frontier{start};
    while (!frontier.empty()) {
        const ImageId image = frontier.back();
        frontier.pop_back();
        for (const ImageId next : state.links[index_of(image)]) {
            const bool inside =
                state.cluster_of[index_of(next)] == state.cluster_of[index_of(image)];
            if (inside && reached.insert(next).second) frontier.push_back(next);
        }
    }
    return reached;
}

/// What ClusteringState promises, and what is left of batch clusters.
void expect_consistent(const ClusteringState& state, const ViewGraph& graph,
                       const ClusteringOptions& options) {
    std::size_t held = 0;
    for (const auto& [id, members] : state.members) {
        ASSERT_TRUE(std::ranges::equal(reached_from(state, members.front()), members));
        for (const ImageId image : members) {
            for (const ImageId other : state.links[index_of(image)]) {
                const ClusterId there = state.cluster_of[index_of(other)];
                if (there == id) continue;
                const std::size_t least = std::min(members.size(), state.members.at(there).size());
                ASSERT_GE(static_cast<double>(least), options.hold_part * options.join_up_to);
                ASSERT_GE(least, 2U);
                ASSERT_GT(members.size() + state.members.at(there).size(), options.join_up_to);
                ++held;
            }
        }
    }
    const auto restored = restore_clustering(graph, clusters_of(state), state.next_id, options);
    ASSERT_TRUE(restored.ok()) << restored.error().message;
    ASSERT_EQ(*restored, state);

    ClusteringState all = state;
    const ClusteringEdit edit = join_late(all, graph, options);
    ASSERT_NO_FATAL_FAILURE(test::expect_edit_tells_all(state.members, all, edit, state.size()));
    ASSERT_EQ(edit.changed.empty(), held == 0);
    std::vector<std::vector<ImageId>> parts;
    for (const auto& [id, members] : all.members) parts.push_back(members);
    std::ranges::sort(parts);
    ASSERT_EQ(parts, batch_clusters(graph, options));
    ASSERT_EQ(join_late(all, graph, options), ClusteringEdit{});
}

ClusteringOptions random_options(synthetic::Rng& rng) {
    constexpr double kEtas[] = {0.2, 0.5, 0.8};
    const double eta = kEtas[rng.below(3)];
    const auto join_up_to = static_cast<std::uint32_t>(2 + rng.below(12));
    return options_with(join_up_to,
                        static_cast<std::uint32_t>(1 + rng.below(std::min(5U, join_up_to))), eta);
}

TEST(HeldClusters, KeepTheirPromisesInEveryOrder) {
    synthetic::Rng rng(11);
    std::size_t held = 0;
    for (int round = 0; round < 800; ++round) {
        SCOPED_TRACE(round);
        const WeightTable table = test::random_weights(rng);
        const ClusteringOptions options = random_options(rng);
        const std::vector<std::size_t> order = synthetic::random_order(table.size, rng.bits());
        ViewGraph graph;
        ClusteringState state;
        for (std::size_t k = 0; k < table.size; ++k) {
            const auto before = state.members;
            const std::vector<ImageId> touched = test::add_next(graph, table, order);
            const ClusteringEdit edit = update_clustering(state, graph, touched, options);
            ASSERT_NO_FATAL_FAILURE(test::expect_edit_tells_all(before, state, edit, k));
            ASSERT_NO_FATAL_FAILURE(expect_consistent(state, graph, options));
        }
        held += state.members.size() - batch_clusters(graph, options).size();
    }
    EXPECT_GT(held, 100U) << "hardly anything was held";
}

TEST(HeldClusters, KeepTheirPromisesWhenEdgesGoAndCome) {
    synthetic::Rng rng(12);
    for (int round = 0; round < 500; ++round) {
        SCOPED_TRACE(round);
        WeightTable table = test::random_weights(rng);
        const ClusteringOptions options = random_options(rng);
        ClusteringState state;
        update_clustering(state, test::graph_of(table), {}, options);
        for (int change = 0; change < 12; ++change) {
            if (rng.below(6) == 0) join_late(state, test::graph_of(table), options);
            const std::vector<ImageId> touched = test::change_some_edges(table, rng);
            const auto before = state.members;
            const ViewGraph graph = test::graph_of(table);
            const ClusteringEdit edit = update_clustering(state, graph, touched, options);
            ASSERT_NO_FATAL_FAILURE(test::expect_edit_tells_all(before, state, edit, table.size));
            ASSERT_NO_FATAL_FAILURE(expect_consistent(state, graph, options));
        }
    }
}

TEST(HeldClusters, JoinOnlyWhenAsked) {
    const WeightTable table = two_groups();
    const ViewGraph graph = test::graph_of(table);
    const ClusteringOptions options = options_with(9, 3);
    ClusteringState state = grown_in_order(table, options);
    EXPECT_EQ(state.members.size(), 2U);
    const ClusteringEdit edit = join_late(state, graph, options);
    ASSERT_EQ(edit.changed.size(), 1U);
    EXPECT_EQ(edit.changed.front(), (ClusterMembers{static_cast<ClusterId>(0), images(0, 11)}));
    EXPECT_EQ(edit.removed.size(), 1U);
    // As many fit in one.
    ClusteringState fitting;
    update_clustering(fitting, graph, {}, options_with(12, 3));
    EXPECT_EQ(fitting.members.size(), 1U);
    // Without a limit nothing is held.
    ClusteringState unlimited;
    update_clustering(unlimited, graph, {}, options_with(0, 3));
    EXPECT_EQ(unlimited.members.size(), 1U);
}

TEST(HeldClusters, AnImageBetweenTwoGoesWithTheOneThatItSharesMostWith) {
    for (const bool second : {false, true}) {
        WeightTable table(13);
        connect(table, 0, 5, 50.0);
        connect(table, 6, 11, 50.0);
        for (std::size_t i = 0; i < 12; ++i) table.set(i, 12, (i >= 6) == second ? 40.0 : 30.0);
        const ClusteringState state = grown_in_order(table, options_with(8, 2, 0.8));
        ASSERT_EQ(state.members.size(), 2U);
        EXPECT_EQ(state.cluster_of[12], state.cluster_of[second ? 6 : 0]);
        EXPECT_NE(state.cluster_of[0], state.cluster_of[6]);
    }
}

TEST(HeldClusters, JoinOnceOneOfThemHasBecomeSmall) {
    WeightTable table = two_groups();
    const ClusteringOptions options = options_with(9, 3);
    ClusteringState state = grown_in_order(table, options);
    ASSERT_EQ(state.members.size(), 2U);
    // Of the first group three images lose the others: the three beside the second one join it.
    for (std::size_t a = 0; a <= 2; ++a) {
        for (std::size_t b = 3; b <= 5; ++b) table.set(a, b, 0.0);
    }
    update_clustering(state, test::graph_of(table), images(0, 5), options);
    ASSERT_EQ(state.members.size(), 2U);
    EXPECT_EQ(state.members.at(state.cluster_of[0]), images(0, 2));
    EXPECT_EQ(state.members.at(state.cluster_of[6]), images(3, 11));
}

TEST(HeldClusters, SingleImagesAreNeverHeld) {
    EXPECT_TRUE(may_join(1, 20, options_with(10, 1)));
    EXPECT_FALSE(may_join(2, 20, options_with(10, 1)));
    EXPECT_TRUE(may_join(99, 5000, ClusteringOptions{}));
    EXPECT_FALSE(may_join(100, 901, ClusteringOptions{}));
    EXPECT_TRUE(may_join(100, 900, ClusteringOptions{}));
}

TEST(HeldClusters, APartToHoldIsAPart) {
    EXPECT_TRUE(validate(options_with(10, 1)).ok());
    EXPECT_FALSE(validate(options_with(10, 0)).ok());
    EXPECT_FALSE(validate(options_with(10, 11)).ok());
}

}  // namespace
}  // namespace psfm
