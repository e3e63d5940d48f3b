// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <immintrin.h>

#include "stages/algorithms/adjustment/coupling_kernel.h"

namespace psfm {
namespace {

/// The first four rows of the block, or what there is of them.
template <std::size_t kDepth>
void add_four_rows(const CouplingRows& left, const double* right, double* block,
                   std::size_t stride) {
    const __m256i rows = _mm256_cmpgt_epi64(_mm256_set1_epi64x(static_cast<long long>(left.rows)),
                                            _mm256_setr_epi64x(0, 1, 2, 3));
    const __m256d first = _mm256_maskload_pd(left.values, rows);
    const __m256d second = _mm256_maskload_pd(left.values + left.stride, rows);
    __m256d third = _mm256_setzero_pd();
    if constexpr (kDepth == 3) third = _mm256_maskload_pd(left.values + 2 * left.stride, rows);
    for (std::size_t column = 0; column < 6; ++column) {
        double* target = block + column * stride;
        __m256d sum = _mm256_maskload_pd(target, rows);
        sum = _mm256_fmadd_pd(first, _mm256_broadcast_sd(right + column), sum);
        sum = _mm256_fmadd_pd(second, _mm256_broadcast_sd(right + 6 + column), sum);
        if constexpr (kDepth == 3)
            sum = _mm256_fmadd_pd(third, _mm256_broadcast_sd(right + 12 + column), sum);
        _mm256_maskstore_pd(target, rows, sum);
    }
}

template <std::size_t kDepth>
void add_product(const CouplingRows& left, const double* right, double* block, std::size_t stride) {
    add_four_rows<kDepth>(left, right, block, stride);
    if (left.rows <= 4) return;
    add_four_rows<kDepth>({left.values + 4, left.stride, left.rows - 4}, right, block + 4, stride);
}

}  // namespace

void coupling_kernel_avx2(const CouplingRows& left, const double* right, std::size_t depth,
                          double* block, std::size_t stride) {
    if (depth == 2)
        add_product<2>(left, right, block, stride);
    else
        add_product<3>(left, right, block, stride);
}

}  // namespace psfm
