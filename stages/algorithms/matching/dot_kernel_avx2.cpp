// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/matching/dot_kernel_256.h"

namespace psfm {
namespace {

/// AVX2 has no exact byte product: vpmaddubsw saturates at 2 * 255 * 128. Bytes are widened in
/// place to 16 bits instead, the even and the odd ones apart, and multiplied by vpmaddwd, which is
/// exact.
struct Avx2Isa : Isa256 {
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

/// Of all lanes.
std::int32_t total(__m256i lanes) {
    lanes = _mm256_add_epi32(lanes, _mm256_permute2x128_si256(lanes, lanes, 1));
    lanes = _mm256_add_epi32(lanes, _mm256_shuffle_epi32(lanes, 0x4E));
    lanes = _mm256_add_epi32(lanes, _mm256_shuffle_epi32(lanes, 0xB1));
    return _mm256_cvtsi256_si32(lanes);
}

}  // namespace

void dot_kernel_avx2(const DotKernelInput& input, const DotKernelOutput& output) {
    DotLoop<Avx2Isa>(input, output).run();
}

void distance_kernel_avx2(const DotKernelInput& input, StripKeys* keys) {
    DotLoop<Avx2Isa>(input, {}).write_keys(keys);
}

void row_sums_avx2(const std::uint8_t* rows, std::size_t count, std::int32_t* sums,
                   std::int32_t* norms) {
    const __m256i zero = _mm256_setzero_si256();
    for (std::size_t i = 0; i < count; ++i, rows += kDescriptorBytes) {
        __m256i bytes = zero;
        __m256i squares = zero;
        for (std::size_t k = 0; k < kDescriptorBytes; k += sizeof(__m256i)) {
            const __m256i some = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(rows + k));
            const __m256i even = _mm256_and_si256(some, _mm256_set1_epi16(0xFF));
            const __m256i odd = _mm256_srli_epi16(some, 8);
            bytes = _mm256_add_epi32(bytes, _mm256_sad_epu8(some, zero));
            squares = _mm256_add_epi32(squares, _mm256_madd_epi16(even, even));
            squares = _mm256_add_epi32(squares, _mm256_madd_epi16(odd, odd));
        }
        sums[i] = total(bytes);
        norms[i] = total(squares);
    }
}

}  // namespace psfm
