// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/adjustment/coupling_kernel.h"

namespace psfm {

void coupling_kernel_portable(const CouplingRows& left, const double* right, std::size_t depth,
                              double* block, std::size_t stride) {
    for (std::size_t k = 0; k < depth; ++k) {
        const double* from = left.values + k * left.stride;
        for (std::size_t column = 0; column < 6; ++column) {
            const double factor = right[6 * k + column];
            double* target = block + column * stride;
            for (std::size_t row = 0; row < left.rows; ++row) target[row] += from[row] * factor;
        }
    }
}

std::vector<NamedCouplingKernel> available_coupling_kernels() {
    std::vector<NamedCouplingKernel> kernels;
#ifdef PSFM_X86_KERNELS
    // Includes the operating system's consent to save the wide registers.
    if (__builtin_cpu_supports("avx512f")) kernels.push_back({"avx512", coupling_kernel_avx512});
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
        kernels.push_back({"avx2", coupling_kernel_avx2});
#endif
    kernels.push_back({"portable", coupling_kernel_portable});
    return kernels;
}

}  // namespace psfm
