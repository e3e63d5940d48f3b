// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/matching/dot_kernel.h"

#ifdef PSFM_X86_KERNELS
#include <cpuid.h>
#endif

namespace psfm {
#ifdef PSFM_X86_KERNELS
namespace {

// Beyond AVX2, whose check includes the operating system's consent. Asked of the processor itself:
// clang 14 has the instructions, but no name for them in __builtin_cpu_supports. Asked once: a
// virtual machine leaves its guest to answer.
bool ask_for_avx_vnni() {
    constexpr unsigned kAvxVnni =
        1U << 4;  // Format: of EAX, leaf 7, subleaf 1 (Intel's manual, CPUID)
    unsigned eax = 0, ebx = 0, ecx = 0, edx = 0;
    return __get_cpuid_count(7, 1, &eax, &ebx, &ecx, &edx) != 0 && (eax & kAvxVnni) != 0;
}

bool has_avx_vnni() {
    static const bool has = ask_for_avx_vnni();
    return has;
}

}  // namespace
#endif

std::vector<NamedDotKernel> available_dot_kernels() {
    std::vector<NamedDotKernel> kernels;
#ifdef PSFM_X86_KERNELS
    // Includes the operating system's consent to save the wide registers.
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
        __builtin_cpu_supports("avx512vnni")) {
        kernels.push_back({"avx512_vnni", dot_kernel_avx512_vnni, distance_kernel_avx512_vnni,
                           row_sums_avx512_vnni});
    }
    if (__builtin_cpu_supports("avx2")) {
        if (has_avx_vnni())
            kernels.push_back(
                {"avx_vnni", dot_kernel_avx_vnni, distance_kernel_avx_vnni, row_sums_avx2});
        kernels.push_back({"avx2", dot_kernel_avx2, distance_kernel_avx2, row_sums_avx2});
    }
#endif
    kernels.push_back(
        {"portable", dot_kernel_portable, distance_kernel_portable, row_sums_portable});
    return kernels;
}

}  // namespace psfm
