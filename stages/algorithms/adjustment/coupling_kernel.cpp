// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/adjustment/coupling_kernel.h"

namespace psfm {

void coupling_kernel_portable(const double* cross, const double* scaled, double* values,
                              std::size_t stride) {
    for (std::size_t column = 0; column < 6; ++column) {
        double* target = values + column * stride;
        for (std::size_t row = 0; row < 6; ++row) {
            target[row] -= cross[row] * scaled[column] + cross[6 + row] * scaled[6 + column] +
                           cross[12 + row] * scaled[12 + column];
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
