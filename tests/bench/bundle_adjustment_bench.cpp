// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Bundle adjustment of a disturbed model of a ring of cameras, everything free: with Ceres, and on
// the reduced camera system, each on one thread.
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include <random>

#include "stages/reconstruction/adjust/bundle_adjustment.h"
#include "tests/stages/reconstruction/scene_model.h"
#include "tests/synthetic/disturb.h"

namespace psfm {
namespace {

void adjust_ring(benchmark::State& state, std::uint32_t max_reduced_mib) {
    const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
    const auto scene = synthetic::add_pixel_noise(
        synthetic::make_scene(
            synthetic::ring_around_sphere(static_cast<std::uint32_t>(state.range(0))), 3),
        0.5, 4);
    AdjustmentOptions options;
    options.max_reduced_mib = max_reduced_mib;
    AdjustmentReport report;
    for (auto _ : state) {
        state.PauseTiming();
        const SceneModel model(scene);
        model.disturb(0.01, 5);
        const AdjustmentScope scope = full_scope(*model.model, true);
        state.ResumeTiming();
        const auto adjusted = adjust(*model.model, scope, options);
        if (!adjusted.ok()) {
            state.SkipWithError(adjusted.error().message.c_str());
            return;
        }
        report = *adjusted;
    }
    state.counters["observations"] = static_cast<double>(report.residuals);
    state.counters["iterations"] = report.iterations;
}

void BM_AdjustWithCeres(benchmark::State& state) {
    adjust_ring(state, 0);
}
void BM_AdjustReduced(benchmark::State& state) {
    adjust_ring(state, AdjustmentOptions{}.max_reduced_mib);
}
BENCHMARK(BM_AdjustWithCeres)->ArgName("images")->Arg(12)->Arg(100)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_AdjustReduced)->ArgName("images")->Arg(12)->Arg(100)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace psfm

BENCHMARK_MAIN();
