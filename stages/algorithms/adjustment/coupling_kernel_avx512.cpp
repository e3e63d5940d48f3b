// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <immintrin.h>

#include "stages/algorithms/adjustment/coupling_kernel.h"

namespace psfm {

void coupling_kernel_avx512(const double* cross, const double* scaled, double* values,
                            std::size_t stride) {
    constexpr __mmask8 kSix = 0x3F;  // Format: a column in one register
    const __m512d first = _mm512_maskz_loadu_pd(kSix, cross);
    const __m512d second = _mm512_maskz_loadu_pd(kSix, cross + 6);
    const __m512d third = _mm512_maskz_loadu_pd(kSix, cross + 12);
    for (std::size_t column = 0; column < 6; ++column) {
        double* target = values + column * stride;
        __m512d sum = _mm512_maskz_loadu_pd(kSix, target);
        sum = _mm512_fnmadd_pd(first, _mm512_set1_pd(scaled[column]), sum);
        sum = _mm512_fnmadd_pd(second, _mm512_set1_pd(scaled[6 + column]), sum);
        sum = _mm512_fnmadd_pd(third, _mm512_set1_pd(scaled[12 + column]), sum);
        _mm512_mask_storeu_pd(target, kSix, sum);
    }
}

}  // namespace psfm
