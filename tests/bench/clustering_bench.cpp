// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What one more image costs the clustering when N are there already. Photographs of places: images
// lie in a plane, each is matched to those near it, all arrive in random order. Two worlds: places
// far apart, so that the graph falls into clusters of about a hundred images; and one path, which
// joins into a single cluster up to some thousand images and into many held apart above.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "graph/view_graph.h"
#include "stages/clustering/clustering_state.h"
#include "stages/clustering/update_clustering.h"
#include "tests/synthetic/rng.h"

namespace {

using psfm::ClusteringState;
using psfm::ImageId;
using psfm::ViewGraph;

/// Images at positions of a row of places; those of one place within kReach of one another are
/// matched, nearer ones better.
class Places {
  public:
    Places(std::size_t count, std::size_t images_a_place, std::uint64_t seed)
        : per_place_(images_a_place), order_(psfm::synthetic::random_order(count, seed)) {
        arrived_.resize(count, kAbsent);
    }

    /// @return touched images
    std::vector<ImageId> add(ViewGraph& graph) {
        const std::size_t position = order_[graph.size()];
        const ImageId image = graph.add_node();
        arrived_[position] = psfm::index_of(image);
        std::vector<ImageId> touched{image};
        const std::size_t first = position / per_place_ * per_place_;
        const std::size_t last = std::min(first + per_place_, order_.size());
        const std::size_t low = position < first + kReach ? first : position - kReach;
        for (std::size_t other = low; other < std::min(last, position + kReach + 1); ++other) {
            if (other == position || arrived_[other] == kAbsent) continue;
            const auto apart =
                static_cast<double>(other > position ? other - position : position - other);
            graph.add_edge(image, static_cast<ImageId>(arrived_[other]),
                           std::ceil(30.0 + 600.0 * std::exp(-apart / 8.0)));
            touched.push_back(static_cast<ImageId>(arrived_[other]));
        }
        return touched;
    }

  private:
    static constexpr std::size_t kReach = 40;
    static constexpr std::uint32_t kAbsent = 0xFFFFFFFFU;
    std::size_t per_place_;
    std::vector<std::size_t> order_;
    std::vector<std::uint32_t> arrived_;
};

/// Time of the last 1000 of range(0) images; range(1): images a place.
void update_one_image(benchmark::State& bench) {
    const auto count = static_cast<std::size_t>(bench.range(0));
    constexpr std::size_t kTimed = 1000;
    for (auto _ : bench) {
        bench.PauseTiming();
        Places places(count, static_cast<std::size_t>(bench.range(1)), 7);
        ViewGraph graph;
        ClusteringState state;
        // Only the state before the timed images matters, and it does not depend on the steps to
        // it.
        std::vector<ImageId> touched;
        while (graph.size() + kTimed < count) {
            for (const ImageId image : places.add(graph)) touched.push_back(image);
        }
        update_clustering(state, graph, touched, {});
        std::size_t listed = 0;
        for (std::size_t k = 0; k < kTimed; ++k) {
            touched = places.add(graph);
            bench.ResumeTiming();
            const psfm::ClusteringEdit edit = update_clustering(state, graph, touched, {});
            bench.PauseTiming();
            for (const psfm::ClusterMembers& cluster : edit.changed)
                listed += cluster.members.size();
        }
        bench.counters["clusters"] = static_cast<double>(state.members.size());
        bench.counters["edges"] = static_cast<double>(graph.edge_count());
        bench.counters["listed/image"] = static_cast<double>(listed) / static_cast<double>(kTimed);
        bench.ResumeTiming();
    }
    bench.counters["s/image"] = benchmark::Counter(
        static_cast<double>(kTimed),
        benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

BENCHMARK(update_one_image)
    ->ArgNames({"images", "place"})
    ->ArgsProduct({{2000, 10000, 50000, 100000}, {100, 1000000}})
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);

}  // namespace

BENCHMARK_MAIN();
