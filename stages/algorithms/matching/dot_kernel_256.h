// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What the kernels of 256-bit registers share. Included by dot_kernel_avx*.cpp only, and of
// internal linkage, for the reason that dot_kernel_loop.h gives.
#pragma once

#include <immintrin.h>

#include "stages/algorithms/matching/dot_kernel_loop.h"

namespace psfm {
namespace {

struct Isa256 {
    /// Format: 32-bit lanes of a register, and a tile whose sums fit the registers.
    static constexpr std::size_t kLanes = 8;
    static constexpr std::size_t kTileRows = 4;
    static constexpr std::size_t kTileStrips = 1;
    using Vector = __m256i;

    static Vector set1(std::int32_t value) { return _mm256_set1_epi32(value); }
    static Vector load(const std::int32_t* from) {
        return _mm256_load_si256(reinterpret_cast<const __m256i*>(from));
    }
    static void store(std::int32_t* to, Vector from) {
        _mm256_store_si256(reinterpret_cast<__m256i*>(to), from);
    }
    static Vector min(Vector a, Vector b) { return _mm256_min_epi32(a, b); }
    static Vector max(Vector a, Vector b) { return _mm256_max_epi32(a, b); }
    static Vector sub(Vector a, Vector b) { return _mm256_sub_epi32(a, b); }
    static Vector times512(Vector a) { return _mm256_slli_epi32(a, 9); }

    /// The lowest lane, in all lanes.
    static Vector lowest(Vector a) {
        a = min(a, _mm256_permute2x128_si256(a, a, 1));
        a = min(a, _mm256_shuffle_epi32(a, 0x4E));
        return min(a, _mm256_shuffle_epi32(a, 0xB1));
    }
    /// A bit for each lane that is equal.
    static unsigned equal(Vector a, Vector b) {
        const __m256 lanes = _mm256_castsi256_ps(_mm256_cmpeq_epi32(a, b));
        return static_cast<unsigned>(_mm256_movemask_ps(lanes));
    }

    static LowestTwo lowest_two(const LaneMinima& lanes) {
        const Vector low = load(lanes.best);
        const Vector high = load(lanes.best + kLanes);
        const Vector best = lowest(min(low, high));
        const unsigned where = equal(low, best) | equal(high, best) << kLanes;
        const int lane = __builtin_ctz(where);
        const Vector numbers = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
        const Vector from_low = _mm256_cmpeq_epi32(numbers, set1(lane));
        const Vector from_high = _mm256_cmpeq_epi32(numbers, set1(lane - int{kLanes}));
        const Vector others = min(_mm256_blendv_epi8(low, load(lanes.second), from_low),
                                  _mm256_blendv_epi8(high, load(lanes.second + kLanes), from_high));
        return {_mm256_cvtsi256_si32(best), _mm256_cvtsi256_si32(lowest(others)),
                static_cast<std::size_t>(lane)};
    }
};

}  // namespace
}  // namespace psfm
