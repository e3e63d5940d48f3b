// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <immintrin.h>

#include "stages/algorithms/matching/dot_kernel_loop.h"

namespace psfm {
namespace {

/// 24 sums, 3 packed columns and one broadcast row: 28 of the 32 registers. vpdpbusd adds four
/// products unsigned byte * signed byte to each 32-bit lane, without saturation.
struct Avx512VnniIsa {
    /// Format: 32-bit lanes of a register, and a tile whose sums fit the registers.
    static constexpr std::size_t kLanes = 16;
    static constexpr std::size_t kTileRows = 8;
    static constexpr std::size_t kTileStrips = 3;
    using Vector = __m512i;

    static Vector set1(std::int32_t value) { return _mm512_set1_epi32(value); }
    static Vector load(const std::int32_t* from) { return _mm512_load_si512(from); }
    static void store(std::int32_t* to, Vector from) { _mm512_store_si512(to, from); }
    static Vector min(Vector a, Vector b) { return _mm512_min_epi32(a, b); }
    static Vector max(Vector a, Vector b) { return _mm512_max_epi32(a, b); }
    static Vector sub(Vector a, Vector b) { return _mm512_sub_epi32(a, b); }
    static Vector times512(Vector a) { return _mm512_slli_epi32(a, 9); }

    PSFM_INLINE static void add_products(const std::uint8_t* rows, const Strip* strips,
                                         std::size_t k, Vector (&sums)[kTileRows][kTileStrips]) {
        Vector columns[kTileStrips];
        unrolled<kTileStrips>([&](auto s) PSFM_INLINE {
            columns[s] = _mm512_load_si512(strips[s].bytes + k * kStripColumns);
        });
        unrolled<kTileRows>([&](auto r) PSFM_INLINE {
            const Vector row = set1(load_four(rows + r * kDescriptorBytes));
            unrolled<kTileStrips>([&](auto s) PSFM_INLINE {
                sums[r][s] = _mm512_dpbusd_epi32(sums[r][s], row, columns[s]);
            });
        });
    }
};

}  // namespace

void dot_kernel_avx512_vnni(const DotKernelInput& input, const DotKernelOutput& output) {
    DotLoop<Avx512VnniIsa>(input, output).run();
}

void distance_kernel_avx512_vnni(const DotKernelInput& input, StripKeys* keys) {
    DotLoop<Avx512VnniIsa>(input, {}).write_keys(keys);
}

}  // namespace psfm
