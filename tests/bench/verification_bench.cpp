// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Verification of one matched pair: E (focal lengths known) or F, and H, with wrong matches.
#include <benchmark/benchmark.h>

#include "stages/verification/verify_pair.h"
#include "tests/stages/verification/two_views.h"

namespace psfm {
namespace {

void BM_VerifyPair(benchmark::State& state) {
    test::TwoViewOptions options;
    options.matches = static_cast<int>(state.range(0));
    options.wrong = static_cast<double>(state.range(1)) / 100.0;
    if (state.range(2) == 0) {
        options.camera1.focal_source = FocalSource::kUnknown;
        options.camera2.focal_source = FocalSource::kUnknown;
    }
    const test::TwoViews views = test::make_two_views(options, 5);
    const MatchedViews matched = views.matched();
    std::size_t inliers = 0;
    for (auto _ : state) {
        const auto geometry = verify_pair(matched, VerifyOptions{}, 7);
        inliers = geometry.ok() ? geometry->inliers.size() : 0;
    }
    state.counters["inliers"] = static_cast<double>(inliers);
    state.counters["pairs/s"] =
        benchmark::Counter(static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}
BENCHMARK(BM_VerifyPair)
    ->ArgNames({"matches", "wrong_percent", "focals_known"})
    ->ArgsProduct({{200, 2000}, {20, 60}, {0, 1}})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace psfm

BENCHMARK_MAIN();
