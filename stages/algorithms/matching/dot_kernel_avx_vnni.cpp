// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <immintrin.h>

#include "stages/algorithms/matching/dot_kernel_loop.h"

namespace psfm {
namespace {

/// vpdpbusd in its 256-bit form, for processors without AVX-512. 8 sums, 2 halves of a strip of
/// columns and one broadcast row: 11 of the 16 registers.
struct AvxVnniIsa {
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

    PSFM_INLINE static void add_products(const std::uint8_t* rows, const Strip* strip,
                                         std::size_t k, Vector (&sums)[kTileRows][2]) {
        const auto* columns = reinterpret_cast<const __m256i*>(strip->bytes + k * kStripColumns);
        const Vector low = _mm256_load_si256(columns);
        const Vector high = _mm256_load_si256(columns + 1);
        unrolled<kTileRows>([&](auto r) PSFM_INLINE {
            const Vector row = set1(load_four(rows + r * kDescriptorBytes));
            sums[r][0] = _mm256_dpbusd_avx_epi32(sums[r][0], row, low);
            sums[r][1] = _mm256_dpbusd_avx_epi32(sums[r][1], row, high);
        });
    }
};

}  // namespace

void dot_kernel_avx_vnni(const DotKernelInput& input, const DotKernelOutput& output) {
    DotLoop<AvxVnniIsa>(input, output).run();
}

void distance_kernel_avx_vnni(const DotKernelInput& input, StripKeys* keys) {
    DotLoop<AvxVnniIsa>(input, {}).write_keys(keys);
}

}  // namespace psfm
