// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Rotation averaging on graphs with noise and outliers: L1 as published, and the refinement of the
// spanning tree that a solve uses.
#include <benchmark/benchmark.h>

#include "stages/algorithms/averaging/average_rotations.h"
#include "stages/reconstruction/model/solve_options.h"
#include "tests/synthetic/rotation_graphs.h"

namespace psfm {
namespace {

std::vector<RelativeRotation> edges_of(const synthetic::RotationGraph& graph) {
    std::vector<RelativeRotation> edges;
    for (const synthetic::RotationEdge& edge : graph.edges) {
        edges.push_back({index_of(edge.pair.first), index_of(edge.pair.second), edge.cam2_from_cam1,
                         edge.weight});
    }
    return edges;
}

void average(benchmark::State& state, const RotationAveragingOptions& options) {
    synthetic::RandomRotationOptions graph;
    graph.nodes = static_cast<std::uint32_t>(state.range(0));
    graph.density = 40.0 / static_cast<double>(graph.nodes);
    const auto edges = edges_of(synthetic::make_random_rotations(graph, 3));
    for (auto _ : state) benchmark::DoNotOptimize(average_rotations(edges, graph.nodes, options));
    state.counters["edges"] = static_cast<double>(edges.size());
}

void BM_AverageL1(benchmark::State& state) {
    average(state, RotationAveragingOptions{});
}
void BM_AverageRefined(benchmark::State& state) {
    average(state, SolveOptions{}.rotation_averaging);
}
BENCHMARK(BM_AverageL1)->ArgName("images")->Arg(100)->Arg(600)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_AverageRefined)->ArgName("images")->Arg(100)->Arg(600)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace psfm

BENCHMARK_MAIN();
