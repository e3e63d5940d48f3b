// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/two_view/sampson_kernel_loop.h"

namespace psfm {

SampsonSums sampson_kernel_avx512(const double* points, std::size_t count, const double* f,
                                  double squared_scale) {
    return sum_sampson<8>(points, count, f, squared_scale);
}

}  // namespace psfm
