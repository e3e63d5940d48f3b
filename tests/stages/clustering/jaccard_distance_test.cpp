// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/clustering/jaccard_distance.h"

#include <gtest/gtest.h>

#include "stages/clustering/batch_clusters.h"
#include "tests/stages/clustering/random_graphs.h"

namespace psfm {
namespace {

using test::graph_of;
using test::WeightTable;

constexpr ImageId kA{0};
constexpr ImageId kB{1};
constexpr ImageId kC{2};

WeightTable complete(std::size_t n) {
    WeightTable table(n);
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < i; ++j) table.set(i, j, 100.0);
    }
    return table;
}

TEST(JaccardDistance, OfATriangleOfEqualEdges) {
    const ViewGraph graph = graph_of(complete(3));
    EXPECT_EQ(jaccard_sums(graph, kA, kB, JaccardForm::kLiteral).distance(), 0.5);
    EXPECT_EQ(jaccard_sums(graph, kA, kB, JaccardForm::kMutual).distance(), 0.0);
}

TEST(JaccardDistance, LiteralFormNeedsSixMutualMatchesAtThePapersEta) {
    const ClusteringOptions literal{.eta = 0.2, .form = JaccardForm::kLiteral, .join_below = 0};
    const ClusteringOptions mutual{.eta = 0.2, .form = JaccardForm::kMutual};
    EXPECT_EQ(batch_clusters(graph_of(complete(6)), literal).size(), 6U);
    EXPECT_EQ(batch_clusters(graph_of(complete(7)), literal).size(), 1U);
    EXPECT_EQ(batch_clusters(graph_of(complete(2)), mutual).size(), 1U);
}

TEST(JaccardDistance, WeighsWhatIsNotShared) {
    WeightTable table(4);  // a-b-c a triangle, d hangs on b
    table.set(0, 1, 10.0);
    table.set(0, 2, 20.0);
    table.set(1, 2, 30.0);
    table.set(1, 3, 40.0);
    const ViewGraph graph = graph_of(table);
    // Degrees: a 30, b 80; common neighbour c adds 20 + 30.
    EXPECT_DOUBLE_EQ(jaccard_sums(graph, kA, kB, JaccardForm::kLiteral).distance(),
                     1.0 - 50.0 / 110.0);
    EXPECT_DOUBLE_EQ(jaccard_sums(graph, kA, kB, JaccardForm::kMutual).distance(),
                     1.0 - 70.0 / 110.0);
}

TEST(JaccardDistance, IsOneWithoutCommonNeighboursOrEdges) {
    WeightTable table(4);
    table.set(0, 1, 10.0);
    table.set(2, 3, 10.0);
    const ViewGraph graph = graph_of(table);
    EXPECT_EQ(jaccard_sums(graph, kA, kC, JaccardForm::kMutual).distance(), 1.0);
    EXPECT_EQ(jaccard_sums(graph, kA, kB, JaccardForm::kLiteral).distance(), 1.0);
    EXPECT_EQ(jaccard_sums(graph_of(WeightTable(2)), kA, kB, JaccardForm::kMutual).distance(), 1.0);
}

TEST(JaccardDistance, OnlyEdgesJoin) {
    // Images 0 and 1 share their only neighbour 2, which has many others: no edge, no join.
    WeightTable table(12);
    for (std::size_t i = 0; i < 12; ++i) {
        if (i != 2) table.set(2, i, 10.0);
    }
    const ViewGraph graph = graph_of(table);
    EXPECT_EQ(jaccard_sums(graph, kA, kB, JaccardForm::kLiteral).distance(), 0.0);
    EXPECT_EQ(batch_clusters(graph, {.join_below = 0}).size(), 12U);
}

TEST(JaccardDistance, IsBitwiseSymmetric) {
    synthetic::Rng rng(11);
    for (int round = 0; round < 200; ++round) {
        const ViewGraph graph = graph_of(test::random_weights(rng));
        const ImageId i{static_cast<std::uint32_t>(rng.below(graph.size()))};
        const ImageId j{static_cast<std::uint32_t>(rng.below(graph.size()))};
        for (const JaccardForm form : {JaccardForm::kMutual, JaccardForm::kLiteral}) {
            const JaccardSums forth = jaccard_sums(graph, i, j, form);
            const JaccardSums back = jaccard_sums(graph, j, i, form);
            EXPECT_EQ(forth.shared, back.shared);
            EXPECT_EQ(forth.all, back.all);
        }
    }
}

TEST(ClusteringOptions, RefusesEtaOutsideZeroToOne) {
    EXPECT_TRUE(validate(ClusteringOptions{}).ok());
    EXPECT_FALSE(validate(ClusteringOptions{.eta = -0.1}).ok());
    EXPECT_FALSE(validate(ClusteringOptions{.eta = 1.1}).ok());
    EXPECT_FALSE(validate(ClusteringOptions{.eta = std::nan("")}).ok());
}

}  // namespace
}  // namespace psfm
