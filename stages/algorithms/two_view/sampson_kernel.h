// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace psfm {

/// Squared gradient below which a correspondence says nothing: both points are on the epipoles.
inline constexpr double kTinySampsonGradient = 1e-30;  // Guard: it is divided by

/// Sums over correspondences that make up a SampsonSystem.
struct SampsonSums {
    std::array<double, 45> information{};  ///< lower triangle, by rows
    std::array<double, 9> gradient{};
    double log_cost = 0.0;  ///< sum of log(1 + residual^2 / scale^2)
};

/// Sampson errors, and their derivatives by the nine elements of f, under the Cauchy loss: the
/// inner loop of two-view refinement.
/// @param points  x1, y1, x2, y2 of each correspondence
/// @param f  3 x 3, by columns
/// Kernels differ in the last digits: they sum in different orders.
using SampsonKernel = SampsonSums (*)(const double* points, std::size_t count, const double* f,
                                      double squared_scale);

SampsonSums sampson_kernel_portable(const double* points, std::size_t count, const double* f,
                                    double squared_scale);
#ifdef PSFM_X86_KERNELS
SampsonSums sampson_kernel_avx2(const double* points, std::size_t count, const double* f,
                                double squared_scale);
SampsonSums sampson_kernel_avx512(const double* points, std::size_t count, const double* f,
                                  double squared_scale);
#endif

struct NamedSampsonKernel {
    const char* name = "";
    SampsonKernel run = nullptr;
};

/// Those that this processor can run, fastest first. Thread-safe.
std::vector<NamedSampsonKernel> available_sampson_kernels();

}  // namespace psfm
