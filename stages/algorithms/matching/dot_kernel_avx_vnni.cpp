// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/matching/dot_kernel_256.h"

namespace psfm {
namespace {

/// vpdpbusd in its 256-bit form, for processors without AVX-512. 8 sums, 2 halves of a strip of
/// columns and one broadcast row: 11 of the 16 registers.
struct AvxVnniIsa : Isa256 {
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
