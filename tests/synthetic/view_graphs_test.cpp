// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/synthetic/view_graphs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tests/synthetic/rng.h"

namespace psfm::synthetic {
namespace {

void expect_invariants(const WeightedGraph& graph) {
    std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;
    EXPECT_TRUE(std::ranges::is_sorted(graph.edges));
    for (const WeightedEdge& edge : graph.edges) {
        EXPECT_LT(edge.a, edge.b);
        EXPECT_LT(edge.b, graph.nodes);
        EXPECT_GE(edge.weight, 1.0);
        EXPECT_EQ(edge.weight, std::round(edge.weight));
        EXPECT_TRUE(pairs.insert({edge.a, edge.b}).second);
    }
}

TEST(MakeAnyGraph, KeepsItsInvariantsAndRepeats) {
    std::size_t with_edges = 0;
    std::size_t nodes = 0;
    for (std::uint64_t seed = 0; seed < 500; ++seed) {
        const WeightedGraph graph = make_any_graph(30, seed);
        expect_invariants(graph);
        EXPECT_LE(graph.nodes, 30U);
        EXPECT_GE(graph.nodes, 1U);
        EXPECT_EQ(graph, make_any_graph(30, seed));
        with_edges += graph.edges.empty() ? 0 : 1;
        nodes += graph.nodes;
    }
    EXPECT_GT(with_edges, 400U);
    EXPECT_GT(nodes, 500U * 10);
    for (std::uint64_t seed = 0; seed < 200; ++seed) EXPECT_LE(make_any_graph(4, seed).nodes, 4U);
}

TEST(ErdosRenyi, HasAboutAsManyEdgesAsExpected) {
    const WeightedGraph graph = make_erdos_renyi(
        {.nodes = 100, .probability = 0.3, .min_weight = 20.0, .max_weight = 90.0}, 1);
    expect_invariants(graph);
    EXPECT_NEAR(static_cast<double>(graph.edges.size()), 0.3 * 4950, 150.0);
    for (const WeightedEdge& edge : graph.edges) {
        EXPECT_GE(edge.weight, 20.0);
        EXPECT_LE(edge.weight, 90.0);
    }
}

TEST(LookAlikeRing, ConnectsNeighboursAndLookAlikes) {
    const LookAlikeRingOptions options{.nodes = 60, .folds = 6, .reach = 4};
    const WeightedGraph graph = make_look_alike_ring(options, 1);
    expect_invariants(graph);
    std::size_t look_alikes = 0;
    double lightest_neighbour = 1e9;
    double heaviest_look_alike = 0.0;
    for (const WeightedEdge& edge : graph.edges) {
        const std::uint32_t apart = std::min(edge.b - edge.a, 60 - (edge.b - edge.a));
        const std::uint32_t folded = std::min(apart % 10, 10 - apart % 10);
        EXPECT_LE(folded, 4U);
        if (apart == 1) lightest_neighbour = std::min(lightest_neighbour, edge.weight);
        if (apart > 5) {
            ++look_alikes;
            heaviest_look_alike = std::max(heaviest_look_alike, edge.weight);
        }
    }
    EXPECT_GT(look_alikes, 500U);
    EXPECT_LT(heaviest_look_alike, lightest_neighbour);
    for (const WeightedEdge& edge :
         make_look_alike_ring({.nodes = 60, .folds = 1, .reach = 4}, 1).edges) {
        EXPECT_LE(std::min(edge.b - edge.a, 60 - (edge.b - edge.a)), 4U);
    }
}

TEST(Communities, AreDenserInside) {
    const WeightedGraph graph = make_communities({}, 1);
    expect_invariants(graph);
    const auto inner = std::ranges::count_if(
        graph.edges, [](const WeightedEdge& e) { return e.a / 8 == e.b / 8; });
    EXPECT_NEAR(static_cast<double>(inner), 0.8 * 4 * 28, 15.0);
    EXPECT_LT(static_cast<double>(graph.edges.size()) - static_cast<double>(inner), 45.0);
}

TEST(Stars, LeavesKnowOnlyTheirHub) {
    const WeightedGraph graph = make_stars({.stars = 3, .leaves_each = 5}, 1);
    expect_invariants(graph);
    EXPECT_EQ(graph.nodes, 18U);
    EXPECT_EQ(graph.edges.size(), 3U * 5 + 2);
    for (const WeightedEdge& edge : graph.edges) EXPECT_EQ(edge.a % 6, 0U);
}

TEST(ReorderNodes, KeepsWeightsUnderNewNames) {
    const WeightedGraph graph = make_communities({}, 2);
    const std::vector<std::size_t> order = random_order(graph.nodes, 3);
    const WeightedGraph renamed = reorder_nodes(graph, order);
    expect_invariants(renamed);
    ASSERT_EQ(renamed.edges.size(), graph.edges.size());
    const ViewGraph before = make_view_graph(graph);
    for (const WeightedEdge& edge : renamed.edges) {
        const ViewGraph::Edge* old =
            before.find(static_cast<ImageId>(order[edge.a]), static_cast<ImageId>(order[edge.b]));
        ASSERT_NE(old, nullptr);
        EXPECT_EQ(old->weight, edge.weight);
    }
}

TEST(Arrivals, BringEveryEdgeOnceWithItsLaterNode) {
    const WeightedGraph graph = make_look_alike_ring({}, 1);
    const auto steps = arrivals(graph);
    ASSERT_EQ(steps.size(), graph.nodes);
    std::vector<WeightedEdge> all;
    for (std::uint32_t node = 0; node < graph.nodes; ++node) {
        for (const WeightedEdge& edge : steps[node]) {
            EXPECT_EQ(edge.b, node);
            all.push_back(edge);
        }
    }
    std::ranges::sort(all);
    EXPECT_EQ(all, graph.edges);
}

}  // namespace
}  // namespace psfm::synthetic
