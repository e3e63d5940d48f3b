// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The loop shared by all Sampson kernels: several correspondences side by side in the lanes of a
// register. Included only by sampson_kernel*.cpp, each of which compiles it for its own instruction
// set: everything here has internal linkage, so that no function compiled for one processor can be
// linked into the path of another. For the same reason no library template is used.
#pragma once

#include "stages/algorithms/two_view/sampson_kernel.h"

namespace psfm {
namespace {

/// Guard: blocks whose factors of the cost are multiplied before their logarithm is taken. Raised:
/// overflow where errors are absurd.
constexpr std::size_t kBlocksPerLogarithm = 4;

template <int kLanes>
struct LanesOf {
    using Type [[gnu::vector_size(kLanes * sizeof(double))]] = double;
};

template <int kLanes>
inline typename LanesOf<kLanes>::Type square_root(typename LanesOf<kLanes>::Type x) {
    for (int lane = 0; lane < kLanes; ++lane) x[lane] = __builtin_sqrt(x[lane]);
    return x;
}

template <int kLanes>
inline double sum_of(const typename LanesOf<kLanes>::Type& x) {
    double sum = 0.0;
    for (int lane = 0; lane < kLanes; ++lane) sum += x[lane];
    return sum;
}

template <int kLanes>
inline SampsonSums sum_sampson(const double* points, std::size_t count, const double* f,
                               double squared_scale) {
    using Lanes = typename LanesOf<kLanes>::Type;
    const double inverse_squared_scale = 1.0 / squared_scale;
    Lanes information[45] = {};
    Lanes gradient[9] = {};
    Lanes factors = {};  // their product, less one
    double log_cost = 0.0;
    std::size_t block = 0;
    for (std::size_t first = 0; first < count; first += kLanes, ++block) {
        Lanes u1 = {};
        Lanes v1 = {};
        Lanes u2 = {};
        Lanes v2 = {};
        for (std::size_t lane = 0; lane < kLanes && first + lane < count; ++lane) {
            const double* point = points + 4 * (first + lane);
            u1[lane] = point[0];
            v1[lane] = point[1];
            u2[lane] = point[2];
            v2[lane] = point[3];
        }
        // The epipolar lines: f * x1 in the second image, f' * x2 in the first.
        const Lanes line2[3] = {f[0] * u1 + f[3] * v1 + f[6], f[1] * u1 + f[4] * v1 + f[7],
                                f[2] * u1 + f[5] * v1 + f[8]};
        const Lanes line1[2] = {f[0] * u2 + f[1] * v2 + f[2], f[3] * u2 + f[4] * v2 + f[5]};
        const Lanes algebraic = u2 * line2[0] + v2 * line2[1] + line2[2];
        const Lanes squared_gradient =
            line2[0] * line2[0] + line2[1] * line2[1] + line1[0] * line1[0] + line1[1] * line1[1];
        Lanes is_counted = {};
        for (std::size_t lane = 0; lane < kLanes && first + lane < count; ++lane)
            is_counted[lane] = squared_gradient[lane] < kTinySampsonGradient ? 0.0 : 1.0;
        const Lanes inverse =
            is_counted / square_root<kLanes>(squared_gradient + (1.0 - is_counted));
        const Lanes residual = algebraic * inverse;
        const Lanes pull = residual * inverse * inverse;
        // d residual / d f(i, j) = x2_i x1_j / g - residual / g^2 (line2_i x1_j [i < 2] + line1_j
        // x2_i [j < 2]).
        const Lanes left[3] = {u2 * inverse - pull * line2[0], v2 * inverse - pull * line2[1],
                               inverse};
        const Lanes top[2] = {pull * line1[0], pull * line1[1]};
        const Lanes jacobian[9] = {left[0] * u1 - u2 * top[0],
                                   left[1] * u1 - v2 * top[0],
                                   left[2] * u1 - top[0],
                                   left[0] * v1 - u2 * top[1],
                                   left[1] * v1 - v2 * top[1],
                                   left[2] * v1 - top[1],
                                   left[0],
                                   left[1],
                                   left[2]};
        const Lanes relative = residual * residual * inverse_squared_scale;
        const Lanes weight = 1.0 / (1.0 + relative);
#pragma GCC unroll 9
        for (int row = 0; row < 9; ++row) {
            const Lanes weighted = weight * jacobian[row];
            gradient[row] += weighted * residual;
#pragma GCC unroll 9
            for (int column = 0; column <= row; ++column)
                information[row * (row + 1) / 2 + column] += weighted * jacobian[column];
        }
        factors += relative + factors * relative;
        if (block % kBlocksPerLogarithm == kBlocksPerLogarithm - 1 || first + kLanes >= count) {
            for (int lane = 0; lane < kLanes; ++lane) log_cost += __builtin_log1p(factors[lane]);
            factors = Lanes{};
        }
    }
    SampsonSums sums;
    double* const information_sums = reinterpret_cast<double*>(&sums.information);
    double* const gradient_sums = reinterpret_cast<double*>(&sums.gradient);
    for (int i = 0; i < 45; ++i) information_sums[i] = sum_of<kLanes>(information[i]);
    for (int i = 0; i < 9; ++i) gradient_sums[i] = sum_of<kLanes>(gradient[i]);
    sums.log_cost = log_cost;
    return sums;
}

}  // namespace
}  // namespace psfm
