// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// One point from the views of many cameras.
#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include "stages/algorithms/pose/triangulation.h"

namespace psfm {
namespace {

void BM_Triangulate(benchmark::State& state) {
    const Eigen::Vector3d point(0.3, -0.2, 0.5);
    std::vector<View> views;
    for (std::int64_t i = 0; i < state.range(0); ++i) {
        const double angle = 0.1 * static_cast<double>(i);
        View view;
        view.cam_from_world = {
            Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY())),
            Eigen::Vector3d(0.0, 0.0, 8.0)};
        view.normalized = (view.cam_from_world * point).hnormalized();
        views.push_back(view);
    }
    for (auto _ : state) benchmark::DoNotOptimize(triangulate(views));
    state.counters["points/s"] =
        benchmark::Counter(static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}
BENCHMARK(BM_Triangulate)->ArgName("views")->Arg(2)->Arg(5)->Arg(20);

}  // namespace
}  // namespace psfm

BENCHMARK_MAIN();
