// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What a version costs that shows one changed cluster, when N images are there: clusters of a
// simulated town with models of their own, a little bent, each in its own gauge, and merging that
// knows what the version before came to. Without copied facades all stand in one frame; with them
// many constraints are folds that contradict others.
#include <benchmark/benchmark.h>

#include <chrono>

#include "stages/merge/run_merge.h"
#include "tests/stages/merge/divided_town.h"

namespace psfm {
namespace {

constexpr std::size_t kTimed = 10;
constexpr std::size_t kImagesOfCluster = 250;

double milliseconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
        .count();
}

void BM_MergeOneChanged(benchmark::State& state) {
    test::DividedTown town(static_cast<std::uint32_t>(state.range(0)), kImagesOfCluster,
                           static_cast<double>(state.range(1)) / 100.0);
    const auto start = std::chrono::steady_clock::now();
    auto result = run_merge(town.problem(), {});
    state.counters["first_ms"] = milliseconds_since(start);
    std::size_t next = 0;
    std::size_t solved = 0;
    for (auto _ : state) {
        state.PauseTiming();
        if (!result.ok()) {
            state.SkipWithError(result.error().message.c_str());
            return;
        }
        town.take_over(*result);
        const std::size_t clusters = town.problem().clusters.size();
        town.change((next++ * clusters / kTimed + clusters / 7) % clusters);
        state.ResumeTiming();
        result = run_merge(town.problem(), {});
        solved += result.ok() ? result->parts_solved : 0;
    }
    state.counters["clusters"] = static_cast<double>(town.problem().clusters.size());
    const auto [wrong, used] = town.wrong_ones(*result);
    state.counters["used"] = static_cast<double>(used);
    state.counters["wrong"] = static_cast<double>(wrong);
    state.counters["frames"] = result->effective_clusters;
    state.counters["parts_solved"] = static_cast<double>(solved) / kTimed;
}
BENCHMARK(BM_MergeOneChanged)
    ->ArgNames({"images", "copied_percent"})
    ->Args({1000, 0})
    ->Args({10000, 0})
    ->Args({30000, 0})
    ->Args({100000, 0})
    ->Args({1000, 15})
    ->Args({10000, 15})
    ->Args({30000, 15})
    ->Args({100000, 15})
    ->Iterations(kTimed)
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace psfm

BENCHMARK_MAIN();
