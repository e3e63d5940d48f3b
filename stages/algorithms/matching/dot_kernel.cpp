// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/matching/dot_kernel.h"

namespace psfm {

std::vector<NamedDotKernel> available_dot_kernels() {
    std::vector<NamedDotKernel> kernels;
#ifdef PSFM_X86_KERNELS
    // Includes the operating system's consent to save the wide registers.
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
        __builtin_cpu_supports("avx512vnni")) {
        kernels.push_back({"avx512_vnni", dot_kernel_avx512_vnni, distance_kernel_avx512_vnni});
    }
    if (__builtin_cpu_supports("avx2")) {
        if (__builtin_cpu_supports("avxvnni"))
            kernels.push_back({"avx_vnni", dot_kernel_avx_vnni, distance_kernel_avx_vnni});
        kernels.push_back({"avx2", dot_kernel_avx2, distance_kernel_avx2});
    }
#endif
    kernels.push_back({"portable", dot_kernel_portable, distance_kernel_portable});
    return kernels;
}

}  // namespace psfm
