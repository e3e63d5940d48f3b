// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "graph/view_graph.h"

#include <gtest/gtest.h>

#include <map>

#include "tests/synthetic/rng.h"
#include "tests/synthetic/view_graphs.h"

namespace psfm {
namespace {

TEST(ViewGraph, StartsEmpty) {
    const ViewGraph graph;
    EXPECT_EQ(graph.size(), 0U);
    EXPECT_EQ(graph.edge_count(), 0U);
}

TEST(ViewGraph, NumbersItsNodes) {
    ViewGraph graph;
    for (std::uint32_t i = 0; i < 5; ++i) EXPECT_EQ(graph.add_node(), ImageId{i});
    EXPECT_EQ(graph.size(), 5U);
    EXPECT_TRUE(graph.edges(ImageId{3}).empty());
    EXPECT_EQ(graph.find(ImageId{0}, ImageId{4}), nullptr);
}

TEST(ViewGraph, KeepsThePairOnBothSides) {
    ViewGraph graph;
    graph.add_node();
    graph.add_node();
    auto pair = std::make_shared<VerifiedPair>();
    pair->pair = {ImageId{0}, ImageId{1}};
    graph.add_edge(ImageId{1}, ImageId{0}, 42.0, pair);
    EXPECT_EQ(graph.edge_count(), 1U);
    for (const std::uint32_t from : {0U, 1U}) {
        const ViewGraph::Edge* edge = graph.find(ImageId{from}, ImageId{1 - from});
        ASSERT_NE(edge, nullptr);
        EXPECT_EQ(edge->neighbor, ImageId{1 - from});
        EXPECT_EQ(edge->weight, 42.0);
        EXPECT_EQ(edge->pair, pair);
    }
}

TEST(ViewGraph, EqualsAMatrixForAnyGraphAndOrderOfEdges) {
    for (std::uint64_t seed = 0; seed < 300; ++seed) {
        synthetic::WeightedGraph truth = synthetic::make_any_graph(25, seed);
        synthetic::Rng rng(seed);
        rng.shuffle(truth.edges);
        std::map<std::pair<std::uint32_t, std::uint32_t>, double> matrix;
        ViewGraph graph;
        for (std::uint32_t i = 0; i < truth.nodes; ++i) graph.add_node();
        for (const synthetic::WeightedEdge& edge : truth.edges) {
            const bool turned = rng.below(2) == 0;
            graph.add_edge(ImageId{turned ? edge.b : edge.a}, ImageId{turned ? edge.a : edge.b},
                           edge.weight);
            matrix[{edge.a, edge.b}] = matrix[{edge.b, edge.a}] = edge.weight;
        }
        ASSERT_EQ(graph.edge_count(), truth.edges.size());
        for (std::uint32_t a = 0; a < truth.nodes; ++a) {
            std::size_t degree = 0;
            for (std::uint32_t b = 0; b < truth.nodes; ++b) {
                const auto expected = matrix.find({a, b});
                const ViewGraph::Edge* edge = graph.find(ImageId{a}, ImageId{b});
                ASSERT_EQ(edge != nullptr, expected != matrix.end());
                if (edge == nullptr) continue;
                EXPECT_EQ(edge->weight, expected->second);
                ++degree;
            }
            const auto edges = graph.edges(ImageId{a});
            ASSERT_EQ(edges.size(), degree);
            for (std::size_t i = 1; i < edges.size(); ++i)
                EXPECT_LT(edges[i - 1].neighbor, edges[i].neighbor);
        }
    }
}

}  // namespace
}  // namespace psfm
