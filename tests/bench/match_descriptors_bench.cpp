// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Descriptor matching beside the peak of the same core: BM_Match reports pairs a second and
// multiply-adds a second; BM_PeakVpdpbusd the multiply-adds of a loop that touches registers only.
// The fraction reached is the quotient of their MAC/s counters. Run pinned: taskset -c 1
// match_descriptors_bench
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "stages/algorithms/matching/match_descriptors.h"
#include "stages/algorithms/matching/match_with_kernel.h"

namespace psfm {
namespace {

/// Rows of length 512 like RootSIFT's; the time does not depend on the values.
Descriptors random_descriptors(std::size_t rows, std::uint32_t seed) {
    std::mt19937 random(seed);
    std::exponential_distribution<double> exponential(1.0);
    Descriptors out;
    std::vector<double> histogram(Descriptors::kSize);
    for (std::size_t i = 0; i < rows; ++i) {
        double sum = 0.0;
        for (double& bin : histogram) sum += bin = exponential(random);
        for (const double bin : histogram) {
            out.values.push_back(static_cast<std::uint8_t>(
                std::min(255.0, std::round(512.0 * std::sqrt(bin / sum)))));
        }
    }
    return out;
}

void count(benchmark::State& state, double multiply_adds_per_iteration) {
    const auto iterations = static_cast<double>(state.iterations());
    state.counters["pairs/s"] = benchmark::Counter(iterations, benchmark::Counter::kIsRate);
    state.counters["MAC/s"] =
        benchmark::Counter(iterations * multiply_adds_per_iteration, benchmark::Counter::kIsRate);
}

void match(benchmark::State& state, DotKernel kernel) {
    const auto rows = static_cast<std::size_t>(state.range(0));
    const Descriptors a = random_descriptors(rows, 1);
    const PackedDescriptors b = pack(random_descriptors(rows, 2));
    for (auto _ : state) benchmark::DoNotOptimize(match_with_kernel(a, b, MatchOptions{}, kernel));
    count(state, static_cast<double>(rows * rows * Descriptors::kSize));
}

void BM_Pack(benchmark::State& state) {
    const Descriptors a = random_descriptors(static_cast<std::size_t>(state.range(0)), 1);
    for (auto _ : state) benchmark::DoNotOptimize(pack(a));
}
BENCHMARK(BM_Pack)->Arg(8000)->Unit(benchmark::kMillisecond);

#ifdef __x86_64__
/// 24 independent sums, as many as the kernel has: enough to hide the latency of vpdpbusd.
__attribute__((target("avx512f,avx512vnni"))) void BM_PeakVpdpbusd(benchmark::State& state) {
    constexpr int kSums = 24;
    constexpr int kRounds = 1000;
    if (!__builtin_cpu_supports("avx512vnni")) {
        state.SkipWithError("this processor has no AVX-512 VNNI");
        return;
    }
    for (auto _ : state) {
        for (int round = 0; round < kRounds; ++round) {
            // Whatever zmm0 and zmm1 hold is multiplied. Written out in assembly: no compiler may
            // move, merge or spill any of it.
            asm volatile(
                ".irp sum,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17,18,19,20,21,22,23,24,25\n"
                "vpdpbusd %%zmm1, %%zmm0, %%zmm\\sum\n"
                ".endr\n"
                :
                :
                : "xmm2", "xmm3", "xmm4", "xmm5", "xmm6", "xmm7", "xmm8", "xmm9", "xmm10", "xmm11",
                  "xmm12", "xmm13", "xmm14", "xmm15", "xmm16", "xmm17", "xmm18", "xmm19", "xmm20",
                  "xmm21", "xmm22", "xmm23", "xmm24", "xmm25");
        }
    }
    count(state, 64.0 * kSums * kRounds);
}
BENCHMARK(BM_PeakVpdpbusd)->Unit(benchmark::kMicrosecond);
#endif

}  // namespace
}  // namespace psfm

int main(int argc, char** argv) {
    for (const psfm::NamedDotKernel& kernel : psfm::available_dot_kernels()) {
        const std::string name = "BM_Match/" + std::string(kernel.name);
        benchmark::RegisterBenchmark(name.c_str(), psfm::match, kernel.kernel)
            ->Arg(2000)
            ->Arg(8000)
            ->Unit(benchmark::kMillisecond);
    }
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
}
