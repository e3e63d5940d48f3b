// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <immintrin.h>

#include "stages/algorithms/matching/dot_kernel_loop.h"

namespace psfm {
namespace {

/// AVX2 has no exact byte product: vpmaddubsw saturates at 2 * 255 * 128. Bytes are widened in
/// place to 16 bits instead, the even and the odd ones apart, and multiplied by vpmaddwd, which is
/// exact.
struct Avx2Isa {
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

    /// The even bytes of each 16-bit element, sign-extended; odd_signed likewise.
    static Vector even_signed(Vector bytes) {
        return _mm256_srai_epi16(_mm256_slli_epi16(bytes, 8), 8);
    }
    static Vector odd_signed(Vector bytes) { return _mm256_srai_epi16(bytes, 8); }

    PSFM_INLINE static void add_products(const std::uint8_t* rows, const Strip* strip,
                                         std::size_t k, Vector (&sums)[kTileRows][2]) {
        const auto* columns = reinterpret_cast<const __m256i*>(strip->bytes + k * kStripColumns);
        Vector even[2];
        Vector odd[2];
        unrolled<2>([&](auto half) PSFM_INLINE {
            const Vector bytes = _mm256_load_si256(columns + half);
            even[half] = even_signed(bytes);
            odd[half] = odd_signed(bytes);
        });
        unrolled<kTileRows>([&](auto r) PSFM_INLINE {
            const Vector bytes = set1(load_four(rows + r * kDescriptorBytes));
            const Vector row_even = _mm256_and_si256(bytes, _mm256_set1_epi16(0xFF));
            const Vector row_odd = _mm256_srli_epi16(bytes, 8);
            unrolled<2>([&](auto half) PSFM_INLINE {
                const Vector products = _mm256_add_epi32(_mm256_madd_epi16(row_even, even[half]),
                                                         _mm256_madd_epi16(row_odd, odd[half]));
                sums[r][half] = _mm256_add_epi32(sums[r][half], products);
            });
        });
    }
};

}  // namespace

void dot_kernel_avx2(const DotKernelInput& input, const DotKernelOutput& output) {
    DotLoop<Avx2Isa>(input, output).run();
}

void distance_kernel_avx2(const DotKernelInput& input, StripKeys* keys) {
    DotLoop<Avx2Isa>(input, {}).write_keys(keys);
}

}  // namespace psfm
