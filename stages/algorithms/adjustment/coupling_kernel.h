// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

namespace psfm {

/// What a point does to the block of two cameras that see it, the inner loop of every bundle
/// adjustment: values -= cross * scaled', matrices by columns.
/// @param cross, scaled  6 x 3
/// @param values  6 x 6, its columns `stride` numbers apart
/// Kernels differ in the last digits: those with fused multiply-adds round once.
using CouplingKernel = void (*)(const double* cross, const double* scaled, double* values,
                                std::size_t stride);

void coupling_kernel_portable(const double* cross, const double* scaled, double* values,
                              std::size_t stride);
#ifdef PSFM_X86_KERNELS
void coupling_kernel_avx2(const double* cross, const double* scaled, double* values,
                          std::size_t stride);
void coupling_kernel_avx512(const double* cross, const double* scaled, double* values,
                            std::size_t stride);
#endif

struct NamedCouplingKernel {
    const char* name = "";
    CouplingKernel run = nullptr;
};

/// Those that this processor can run, fastest first. Thread-safe.
std::vector<NamedCouplingKernel> available_coupling_kernels();

}  // namespace psfm
