// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <vector>

#include "stages/clustering/clustering_state.h"
#include "stages/clustering/update_clustering.h"
#include "tests/stages/clustering/random_graphs.h"

namespace psfm {
namespace {

TEST(RestoreClustering, ContinuesAsIfNeverInterrupted) {
    synthetic::Rng rng(5);
    for (int round = 0; round < 200; ++round) {
        const test::WeightTable table = test::random_weights(rng);
        const std::vector<std::size_t> order = synthetic::random_order(table.size, rng.bits());
        const std::size_t interrupted = rng.below(table.size);
        ViewGraph graph;
        ClusteringState streamed;
        ClusteringState resumed;
        for (std::size_t k = 0; k < table.size; ++k) {
            if (k == interrupted) {
                auto restored =
                    restore_clustering(graph, clusters_of(streamed), streamed.next_id, {});
                ASSERT_TRUE(restored.ok());
                resumed = std::move(*restored);
            }
            const std::vector<ImageId> touched = test::add_next(graph, table, order);
            const ClusteringEdit edit = update_clustering(streamed, graph, touched, {});
            if (k >= interrupted) {
                ASSERT_EQ(update_clustering(resumed, graph, touched, {}), edit);
                ASSERT_EQ(resumed, streamed);
            }
        }
    }
}

class RestoreClusteringRefuses : public testing::Test {
  protected:
    RestoreClusteringRefuses() {
        test::WeightTable table(4);
        table.set(0, 1, 40.0);
        table.set(2, 3, 40.0);
        graph_ = test::graph_of(table);
    }
    ErrorCode refusal(const std::vector<ClusterMembers>& clusters, std::uint32_t next_id = 2) {
        auto restored = restore_clustering(graph_, clusters, static_cast<ClusterId>(next_id), {});
        EXPECT_FALSE(restored.ok());
        return restored.ok() ? ErrorCode::kInternal : restored.error().code;
    }
    static ClusterMembers cluster(std::uint32_t id, std::vector<std::uint32_t> numbers) {
        ClusterMembers result{static_cast<ClusterId>(id), {}};
        for (const std::uint32_t n : numbers) result.members.push_back(static_cast<ImageId>(n));
        return result;
    }
    ViewGraph graph_;
};

TEST_F(RestoreClusteringRefuses, WhatIsNotThisGraphsClustering) {
    EXPECT_TRUE(restore_clustering(graph_, std::vector{cluster(0, {0, 1}), cluster(1, {2, 3})},
                                   static_cast<ClusterId>(2), {})
                    .ok());
    constexpr ErrorCode kInvalid = ErrorCode::kInvalidArgument;
    EXPECT_EQ(refusal({cluster(0, {0, 1, 2, 3})}), kInvalid);  // two parts
    EXPECT_EQ(refusal({cluster(0, {0}), cluster(1, {1}), cluster(2, {2, 3})}, 3),
              kInvalid);                                                        // torn
    EXPECT_EQ(refusal({cluster(0, {0, 1})}), kInvalid);                         // missing
    EXPECT_EQ(refusal({cluster(0, {0, 1}), cluster(1, {1, 2, 3})}), kInvalid);  // twice
    EXPECT_EQ(refusal({cluster(0, {0, 1}), cluster(1, {3, 2})}), kInvalid);     // unsorted
    EXPECT_EQ(refusal({cluster(0, {0, 1}), cluster(1, {2, 3, 4})}), kInvalid);  // unknown
    EXPECT_EQ(refusal({cluster(0, {0, 1}), cluster(2, {2, 3})}), kInvalid);     // id too high
    EXPECT_EQ(refusal({cluster(0, {0, 1}), cluster(0, {2, 3})}), kInvalid);     // id twice
    EXPECT_EQ(refusal({cluster(0, {0, 1}), cluster(1, {2, 3}), cluster(2, {})}, 3), kInvalid);
}

TEST_F(RestoreClusteringRefuses, OtherOptionsThanTheSessions) {
    const ClusteringOptions generous{.eta = 1.0};
    std::vector<ClusterMembers> alone;
    for (std::uint32_t i = 0; i < graph_.size(); ++i) alone.push_back(cluster(i, {i}));
    EXPECT_FALSE(
        restore_clustering(graph_, alone, static_cast<ClusterId>(graph_.size()), generous).ok());
}

}  // namespace
}  // namespace psfm
