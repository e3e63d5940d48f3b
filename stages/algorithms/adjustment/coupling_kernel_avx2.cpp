// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <immintrin.h>

#include "stages/algorithms/adjustment/coupling_kernel.h"

namespace psfm {

void coupling_kernel_avx2(const double* cross, const double* scaled, double* values,
                          std::size_t stride) {
    // A column in one register of four numbers and one of two.
    const __m256d first = _mm256_loadu_pd(cross);
    const __m256d second = _mm256_loadu_pd(cross + 6);
    const __m256d third = _mm256_loadu_pd(cross + 12);
    const __m128d first_low = _mm_loadu_pd(cross + 4);
    const __m128d second_low = _mm_loadu_pd(cross + 10);
    const __m128d third_low = _mm_loadu_pd(cross + 16);
    for (std::size_t column = 0; column < 6; ++column) {
        double* target = values + column * stride;
        const __m256d x = _mm256_set1_pd(scaled[column]);
        const __m256d y = _mm256_set1_pd(scaled[6 + column]);
        const __m256d z = _mm256_set1_pd(scaled[12 + column]);
        __m256d four = _mm256_loadu_pd(target);
        four = _mm256_fnmadd_pd(first, x, four);
        four = _mm256_fnmadd_pd(second, y, four);
        four = _mm256_fnmadd_pd(third, z, four);
        _mm256_storeu_pd(target, four);
        __m128d two = _mm_loadu_pd(target + 4);
        two = _mm_fnmadd_pd(first_low, _mm256_castpd256_pd128(x), two);
        two = _mm_fnmadd_pd(second_low, _mm256_castpd256_pd128(y), two);
        two = _mm_fnmadd_pd(third_low, _mm256_castpd256_pd128(z), two);
        _mm_storeu_pd(target + 4, two);
    }
}

}  // namespace psfm
