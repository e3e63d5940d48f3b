// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <immintrin.h>

#include "stages/algorithms/adjustment/coupling_kernel.h"

namespace psfm {
namespace {

template <std::size_t kDepth>
void add_product(const CouplingRows& left, const double* right, double* block, std::size_t stride) {
    // A column in one register.
    const auto rows = static_cast<__mmask8>((1U << left.rows) - 1U);
    const __m512d first = _mm512_maskz_loadu_pd(rows, left.values);
    const __m512d second = _mm512_maskz_loadu_pd(rows, left.values + left.stride);
    __m512d third = _mm512_setzero_pd();
    if constexpr (kDepth == 3) third = _mm512_maskz_loadu_pd(rows, left.values + 2 * left.stride);
    for (std::size_t column = 0; column < 6; ++column) {
        double* target = block + column * stride;
        __m512d sum = _mm512_maskz_loadu_pd(rows, target);
        sum = _mm512_fmadd_pd(first, _mm512_set1_pd(right[column]), sum);
        sum = _mm512_fmadd_pd(second, _mm512_set1_pd(right[6 + column]), sum);
        if constexpr (kDepth == 3)
            sum = _mm512_fmadd_pd(third, _mm512_set1_pd(right[12 + column]), sum);
        _mm512_mask_storeu_pd(target, rows, sum);
    }
}

}  // namespace

void coupling_kernel_avx512(const CouplingRows& left, const double* right, std::size_t depth,
                            double* block, std::size_t stride) {
    if (depth == 2)
        add_product<2>(left, right, block, stride);
    else
        add_product<3>(left, right, block, stride);
}

}  // namespace psfm
