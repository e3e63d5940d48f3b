// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/two_view/sampson_kernel.h"

#include "stages/algorithms/two_view/sampson_kernel_loop.h"

namespace psfm {

SampsonSums sampson_kernel_portable(const double* points, std::size_t count, const double* f,
                                    double squared_scale) {
    return sum_sampson<2>(points, count, f, squared_scale);
}

std::vector<NamedSampsonKernel> available_sampson_kernels() {
    std::vector<NamedSampsonKernel> kernels;
#ifdef PSFM_X86_KERNELS
    // Includes the operating system's consent to save the wide registers.
    if (__builtin_cpu_supports("avx512f")) kernels.push_back({"avx512", sampson_kernel_avx512});
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
        kernels.push_back({"avx2", sampson_kernel_avx2});
#endif
    kernels.push_back({"portable", sampson_kernel_portable});
    return kernels;
}

}  // namespace psfm
