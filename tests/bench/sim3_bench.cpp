// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Similarities between two models from corresponding points: least squares, and RANSAC with a third
// of the points wrong.
#include <benchmark/benchmark.h>

#include <vector>

#include "stages/algorithms/alignment/estimate_sim3.h"
#include "stages/algorithms/alignment/sim3_ransac.h"
#include "tests/synthetic/rng.h"

namespace psfm {
namespace {

/// One edge whose every third correspondence is wrong, if so asked.
EdgeCorrespondences make_edge(std::size_t count, bool with_wrong) {
    synthetic::Rng rng(3);
    const auto anywhere = [&]() -> Eigen::Vector3d {
        return {rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)};
    };
    Sim3 b_from_a;
    b_from_a.scale = 2.0;
    b_from_a.rotation = Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, 3).normalized());
    b_from_a.translation = {1, -2, 0.5};
    EdgeCorrespondences edge;
    for (std::size_t i = 0; i < count; ++i) {
        const Eigen::Vector3d in_a = anywhere();
        const bool is_wrong = with_wrong && i % 3 == 0;
        edge.points.push_back({in_a, is_wrong ? anywhere() : Eigen::Vector3d(b_from_a * in_a)});
    }
    return edge;
}

void BM_EstimateSim3(benchmark::State& state) {
    const EdgeCorrespondences edge = make_edge(static_cast<std::size_t>(state.range(0)), false);
    std::vector<Eigen::Vector3d> source, target;
    for (const PointCorrespondence& point : edge.points) {
        source.push_back(point.in_a);
        target.push_back(point.in_b);
    }
    for (auto _ : state) benchmark::DoNotOptimize(estimate_sim3(source, target));
}
BENCHMARK(BM_EstimateSim3)->ArgName("points")->Arg(100)->Arg(2000)->Unit(benchmark::kMicrosecond);

void BM_Sim3Ransac(benchmark::State& state) {
    const std::vector<EdgeCorrespondences> edges{
        make_edge(static_cast<std::size_t>(state.range(0)), true)};
    for (auto _ : state)
        benchmark::DoNotOptimize(estimate_sim3_ransac(edges, {}, ClusterConstraintOptions{}, 5));
}
BENCHMARK(BM_Sim3Ransac)->ArgName("points")->Arg(100)->Arg(2000)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace psfm

BENCHMARK_MAIN();
