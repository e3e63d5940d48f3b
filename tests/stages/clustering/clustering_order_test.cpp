// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The promise of the clustering stage: any graph, any order, any batch size, edges added, dropped
// or reweighted, ends in the clusters that a batch run finds; and each edit says exactly what
// changed.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <vector>

#include "stages/clustering/batch_clusters.h"
#include "stages/clustering/clustering_state.h"
#include "stages/clustering/update_clustering.h"
#include "tests/stages/clustering/check_edit.h"
#include "tests/stages/clustering/random_graphs.h"

namespace psfm {
namespace {

using test::expect_edit_tells_all;
using test::WeightTable;

ClusteringOptions random_options(synthetic::Rng& rng) {
    constexpr double kEtas[] = {0.05, 0.2, 0.3, 0.5, 0.8};
    return {.eta = kEtas[rng.below(5)],
            .form = rng.below(2) == 0 ? JaccardForm::kMutual : JaccardForm::kLiteral,
            .join_below = 0};
}

std::vector<std::vector<ImageId>> partition(const ClusteringState& state) {
    std::vector<std::vector<ImageId>> parts;
    for (const auto& [id, members] : state.members) parts.push_back(members);
    std::ranges::sort(parts);
    return parts;
}

void expect_consistent(const ClusteringState& state, const ViewGraph& graph,
                       const ClusteringOptions& options) {
    ASSERT_EQ(partition(state), batch_clusters(graph, options));
    auto restored = restore_clustering(graph, clusters_of(state), state.next_id, options);
    ASSERT_TRUE(restored.ok()) << restored.error().message;
    ASSERT_EQ(*restored, state);
    for (const double weight : state.workspace.weight) ASSERT_EQ(weight, 0.0);
}

/// A former cluster's id stays with one of its largest parts, or the joint cluster has another
/// one's id that brought at least as many.
void expect_ids_kept(const std::map<ClusterId, std::vector<ImageId>>& before,
                     const ClusteringState& after) {
    const auto part_sizes = [&](ClusterId from) {
        std::map<ClusterId, std::size_t> sizes;
        for (const ImageId image : before.at(from)) ++sizes[after.cluster_of[index_of(image)]];
        return sizes;
    };
    for (const auto& [id, members] : before) {
        const std::map<ClusterId, std::size_t> sizes = part_sizes(id);
        std::size_t largest = 0;
        for (const auto& [to, size] : sizes) largest = std::max(largest, size);
        if (after.members.contains(id)) {
            ASSERT_TRUE(sizes.contains(id)) << "an id went to images it never had";
            ASSERT_EQ(sizes.at(id), largest);
            continue;
        }
        const bool outbid = std::ranges::any_of(sizes, [&](const auto& part) {
            return part.second == largest && before.contains(part.first) &&
                   part_sizes(part.first).at(part.first) >= largest;
        });
        ASSERT_TRUE(outbid) << "cluster " << index_of(id) << " lost its id to nobody";
    }
}

TEST(ClusteringOrder, StreamingEqualsBatchAfterEveryImage) {
    synthetic::Rng rng(1);
    for (int round = 0; round < 1500; ++round) {
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
            ASSERT_NO_FATAL_FAILURE(expect_edit_tells_all(before, state, edit, k));
            ASSERT_NO_FATAL_FAILURE(expect_ids_kept(before, state));
            ASSERT_NO_FATAL_FAILURE(expect_consistent(state, graph, options));
        }
    }
}

TEST(ClusteringOrder, EveryOrderAndBatchSizeEndsInTheSameClusters) {
    synthetic::Rng rng(2);
    for (int round = 0; round < 500; ++round) {
        SCOPED_TRACE(round);
        const WeightTable table = test::random_weights(rng);
        const ClusteringOptions options = random_options(rng);
        std::vector<std::vector<std::size_t>> expected;
        for (const std::vector<ImageId>& cluster : batch_clusters(test::graph_of(table), options)) {
            std::vector<std::size_t>& rows = expected.emplace_back();
            for (const ImageId image : cluster) rows.push_back(index_of(image));
        }
        for (int repeat = 0; repeat < 4; ++repeat) {
            const std::vector<std::size_t> order = synthetic::random_order(table.size, rng.bits());
            ViewGraph graph;
            ClusteringState state;
            while (graph.size() < table.size) {
                std::vector<ImageId> touched;
                for (std::size_t batch = 1 + rng.below(5); batch > 0 && graph.size() < table.size;
                     --batch) {
                    for (const ImageId image : test::add_next(graph, table, order)) {
                        touched.push_back(image);
                    }
                }
                rng.shuffle(touched);
                update_clustering(state, graph, touched, options);
            }
            std::vector<std::vector<std::size_t>> found;
            for (const auto& [id, members] : state.members) {
                std::vector<std::size_t>& rows = found.emplace_back();
                for (const ImageId image : members) rows.push_back(order[index_of(image)]);
                std::ranges::sort(rows);
            }
            std::ranges::sort(found);
            // Sums of fractions depend on the order of neighbours, and a distance that lies on eta
            // may then fall on either side; with whole weights, as the pipeline has, all sums are
            // exact.
            const bool whole = std::ranges::all_of(
                table.values, [](double weight) { return weight == std::floor(weight); });
            if (whole) {
                ASSERT_EQ(found, expected);
            }
        }
    }
}

TEST(ClusteringOrder, DroppedAndReweightedEdgesEqualBatch) {
    synthetic::Rng rng(3);
    for (int round = 0; round < 800; ++round) {
        SCOPED_TRACE(round);
        WeightTable table = test::random_weights(rng);
        const ClusteringOptions options = random_options(rng);
        ClusteringState state;
        update_clustering(state, test::graph_of(table), {}, options);
        for (int change = 0; change < 12; ++change) {
            const std::vector<ImageId> touched = test::change_some_edges(table, rng);
            const auto before = state.members;
            const ViewGraph graph = test::graph_of(table);
            const ClusteringEdit edit = update_clustering(state, graph, touched, options);
            ASSERT_NO_FATAL_FAILURE(expect_edit_tells_all(before, state, edit, table.size));
            ASSERT_NO_FATAL_FAILURE(expect_ids_kept(before, state));
            ASSERT_NO_FATAL_FAILURE(expect_consistent(state, graph, options));
        }
    }
}

TEST(ClusteringOrder, NothingTouchedNothingChanged) {
    synthetic::Rng rng(4);
    const ViewGraph graph = test::graph_of(test::random_weights(rng));
    ClusteringState state;
    update_clustering(state, graph, {}, {});
    const ClusteringState before = state;
    std::vector<ImageId> all;
    for (std::uint32_t i = 0; i < graph.size(); ++i) all.push_back(static_cast<ImageId>(i));
    EXPECT_EQ(update_clustering(state, graph, {}, {}), ClusteringEdit{});
    EXPECT_EQ(update_clustering(state, graph, all, {}), ClusteringEdit{});
    EXPECT_EQ(state, before);
}

}  // namespace
}  // namespace psfm
