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

    static LowestTwo lowest_two(const LaneMinima& lanes) {
        const Vector best = load(lanes.best);
        const std::int32_t lowest = _mm512_reduce_min_epi32(best);
        const unsigned where = _mm512_cmpeq_epi32_mask(best, set1(lowest));
        const __mmask16 first = static_cast<__mmask16>(where & (0U - where));
        const Vector others = _mm512_mask_mov_epi32(best, first, load(lanes.second));
        return {lowest, _mm512_reduce_min_epi32(others),
                static_cast<std::size_t>(__builtin_ctz(where))};
    }

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

/// b * b = b * (b - 128) + 128 * b, of which vpdpbusd adds the first.
void row_sums_avx512_vnni(const std::uint8_t* rows, std::size_t count, std::int32_t* sums,
                          std::int32_t* norms) {
    const __m512i zero = _mm512_setzero_si512();
    const __m512i top_bits = _mm512_set1_epi8(-128);
    for (std::size_t i = 0; i < count; ++i, rows += kDescriptorBytes) {
        const __m512i a = _mm512_loadu_si512(rows);
        const __m512i b = _mm512_loadu_si512(rows + kDescriptorBytes / 2);
        __m512i products = _mm512_dpbusd_epi32(zero, a, _mm512_xor_si512(a, top_bits));
        products = _mm512_dpbusd_epi32(products, b, _mm512_xor_si512(b, top_bits));
        const __m512i bytes = _mm512_add_epi32(_mm512_sad_epu8(a, zero), _mm512_sad_epu8(b, zero));
        sums[i] = _mm512_reduce_add_epi32(bytes);
        norms[i] = _mm512_reduce_add_epi32(products) + 128 * sums[i];
    }
}

}  // namespace psfm
