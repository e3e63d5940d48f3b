// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

namespace psfm {

/// Rows of a product's left side, by columns that are `stride` numbers apart: rows x depth.
struct CouplingRows {
    const double* values = nullptr;
    std::size_t stride = 0;
    std::size_t rows = 0;  ///< 8 at most
};

/// What one observation, or one point, does to a pose's columns of a reduced camera system, the
/// inner loop of every bundle adjustment: block += left * right'.
/// @param right  6 x depth, by columns
/// @param depth  2, of an observation, or 3, of a point
/// @param block  left.rows x 6, its columns `stride` numbers apart
/// Kernels differ in the last digits: those with fused multiply-adds round once.
using CouplingKernel = void (*)(const CouplingRows& left, const double* right, std::size_t depth,
                                double* block, std::size_t stride);

void coupling_kernel_portable(const CouplingRows& left, const double* right, std::size_t depth,
                              double* block, std::size_t stride);
#ifdef PSFM_X86_KERNELS
void coupling_kernel_avx2(const CouplingRows& left, const double* right, std::size_t depth,
                          double* block, std::size_t stride);
void coupling_kernel_avx512(const CouplingRows& left, const double* right, std::size_t depth,
                            double* block, std::size_t stride);
#endif

struct NamedCouplingKernel {
    const char* name = "";
    CouplingKernel run = nullptr;
};

/// Those that this processor can run, fastest first. Thread-safe.
std::vector<NamedCouplingKernel> available_coupling_kernels();

}  // namespace psfm
