// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "graph/view_graph.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <utility>
#include <vector>

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

VerifiedPairPtr pair_of(std::uint32_t a, std::uint32_t b, std::size_t inliers) {
    VerifiedPair pair{ImagePair::of(ImageId{a}, ImageId{b}), {}};
    pair.geometry.inliers.resize(inliers);
    return std::make_shared<const VerifiedPair>(std::move(pair));
}

void expect_equal(const ViewGraph& x, const ViewGraph& y) {
    ASSERT_EQ(x.size(), y.size());
    EXPECT_EQ(x.edge_count(), y.edge_count());
    for (std::uint32_t i = 0; i < x.size(); ++i) {
        EXPECT_TRUE(std::ranges::equal(x.edges(ImageId{i}), y.edges(ImageId{i}),
                                       [](const ViewGraph::Edge& a, const ViewGraph::Edge& b) {
                                           return a.neighbor == b.neighbor &&
                                                  a.weight == b.weight && a.pair == b.pair;
                                       }))
            << i;
    }
}

TEST(ViewGraph, OfPairsEqualsOneThatIsMadeEdgeByEdge) {
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
        synthetic::Rng rng(seed);
        // Up to several times as many images as are copied together, most of them without edges.
        const std::size_t images = 2 + rng.below(300);
        std::map<ImagePair, VerifiedPairPtr> drawn;
        for (std::size_t i = 0; i < 100; ++i) {
            const auto a = static_cast<std::uint32_t>(rng.below(images));
            const auto b = static_cast<std::uint32_t>(rng.below(images));
            const VerifiedPairPtr pair = pair_of(a, b, 1 + rng.below(9));
            if (a != b) drawn.emplace(pair->pair, pair);
        }
        std::vector<VerifiedPairPtr> pairs;
        ViewGraph expected;
        for (const auto& [ends, pair] : drawn) {
            pairs.push_back(pair);
            while (expected.size() <= index_of(ends.second)) expected.add_node();
            expected.add_edge(ends.second, ends.first,
                              static_cast<double>(pair->geometry.inliers.size()), pair);
        }
        rng.shuffle(pairs);
        ViewGraph graph(pairs);
        expect_equal(graph, expected);
        // And goes on as one.
        for (ViewGraph* either : {&graph, &expected}) {
            const ImageId node = either->add_node();
            either->add_edge(node, ImageId{0}, 2.0);
            if (!pairs.empty()) either->remove_edge(pairs[0]->pair.first, pairs[0]->pair.second);
        }
        expect_equal(graph, expected);
    }
    EXPECT_EQ(ViewGraph(std::vector<VerifiedPairPtr>()).size(), 0U);
}

TEST(ViewGraph, HasNoEdgesOfImagesThatAreNoNodes) {
    ViewGraph graph;
    EXPECT_TRUE(graph.edges(ImageId{0}).empty());
    graph.add_node();
    for (const std::uint32_t image : {1U, 63U, 64U, 1'000'000U, 0xffffffffU}) {
        EXPECT_TRUE(graph.edges(ImageId{image}).empty()) << image;
        EXPECT_EQ(graph.find(ImageId{image}, ImageId{0}), nullptr) << image;
    }
}

TEST(ViewGraph, CopiesAreIndependent) {
    ViewGraph graph(std::array{pair_of(0, 1, 3), pair_of(1, 2, 4), pair_of(2, 70, 5)});
    const ViewGraph before(std::array{graph.find(ImageId{0}, ImageId{1})->pair,
                                      graph.find(ImageId{1}, ImageId{2})->pair,
                                      graph.find(ImageId{2}, ImageId{70})->pair});
    const ViewGraph copy = graph;
    EXPECT_EQ(copy.edges(ImageId{1}).data(), graph.edges(ImageId{1}).data()) << "shared so far";
    graph.add_edge(ImageId{0}, ImageId{2}, 1.0);
    graph.remove_edge(ImageId{70}, ImageId{2});
    graph.add_edge(graph.add_node(), ImageId{0}, 1.0);
    expect_equal(copy, before);
    EXPECT_EQ(graph.size(), 72U);
    EXPECT_EQ(copy.find(ImageId{0}, ImageId{2}), nullptr);
    EXPECT_EQ(copy.edges(ImageId{1}).data(), graph.edges(ImageId{1}).data()) << "and still";

    ViewGraph other = copy;
    other.remove_edge(ImageId{0}, ImageId{1});
    while (other.size() < 200) other.add_node();
    other.add_edge(ImageId{199}, ImageId{1}, 1.0);
    expect_equal(copy, before);
    graph = copy;
    expect_equal(graph, before);
    EXPECT_EQ(other.edge_count(), 3U);
}

/// Several graphs that are copied over one another, each beside a set of edges of its own.
TEST(ViewGraph, EqualsASetOfEdgesWhateverIsCopiedAndChanged) {
    using Edges = std::map<ImagePair, double>;
    struct Value {
        ViewGraph graph;
        Edges edges;
        std::size_t nodes = 0;
    };
    synthetic::Rng rng(1);
    std::array<Value, 4> values;
    for (int step = 0; step < 20'000; ++step) {
        Value& value = values[rng.below(values.size())];
        if (rng.below(100) == 0) value = Value(values[rng.below(values.size())]);
        if (value.nodes < 2 || rng.below(30) == 0) {
            ASSERT_EQ(value.graph.add_node(), static_cast<ImageId>(value.nodes++));
            continue;
        }
        const auto a = static_cast<std::uint32_t>(rng.below(value.nodes));
        const auto b = static_cast<std::uint32_t>(rng.below(value.nodes));
        if (a == b) continue;
        const ImagePair ends = ImagePair::of(ImageId{a}, ImageId{b});
        if (value.edges.erase(ends) > 0) {
            value.graph.remove_edge(ImageId{a}, ImageId{b});
        } else {
            value.graph.add_edge(ImageId{a}, ImageId{b}, step + 1.0);
            value.edges[ends] = step + 1.0;
        }
    }
    for (const Value& value : values) {
        ViewGraph expected;
        for (std::size_t i = 0; i < value.nodes; ++i) expected.add_node();
        for (const auto& [ends, weight] : value.edges)
            expected.add_edge(ends.first, ends.second, weight);
        EXPECT_GT(value.nodes, 64U);
        expect_equal(value.graph, expected);
    }
}

}  // namespace
}  // namespace psfm
