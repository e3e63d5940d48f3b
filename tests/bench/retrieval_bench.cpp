// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Retrieval: what one more image costs when N are indexed, on one thread. Images stand on a ring,
// each sees what its neighbours see.
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include "stages/retrieval/run_retrieval.h"
#include "tests/stages/retrieval/planted_descriptors.h"

namespace psfm {
namespace {

constexpr std::size_t kTimed = 20;
constexpr std::size_t kFeatures = 1000;

void BM_Retrieve(benchmark::State& state) {
    const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
    const auto indexed = static_cast<std::uint32_t>(state.range(0));
    const synthetic::Ring ring(indexed + kTimed, kFeatures, kFeatures / 20, 3);
    RetrievalOptions options;
    options.max_words = 20000;
    auto rebuilt = rebuild_retrieval(nullptr, indexed, ring.source(), options);
    if (!rebuilt.ok()) {
        state.SkipWithError(rebuilt.error().message.c_str());
        return;
    }
    std::uint32_t next = indexed;
    for (auto _ : state) {
        benchmark::DoNotOptimize(
            run_retrieval(*rebuilt, ImageId{next}, *ring.images[next], ring.source(), options));
        ++next;
    }
}
BENCHMARK(BM_Retrieve)
    ->ArgName("images")
    ->Arg(150)
    ->Arg(600)
    ->Iterations(kTimed)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace psfm

BENCHMARK_MAIN();
