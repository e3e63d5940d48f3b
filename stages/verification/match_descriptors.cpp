// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/verification/match_descriptors.h"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <span>

#include "stages/verification/dot_kernel.h"
#include "stages/verification/match_with_kernel.h"
#include "stages/verification/nearest_descriptors.h"

namespace psfm {
namespace {

/// RootSIFT bytes of a descriptor of length 1 have Euclidean length 512 (graph/image.h).
constexpr double kUnit = 512.0;
static_assert(kDescriptorBytes == Descriptors::kSize);

std::int32_t squared_norm(const std::uint8_t* row) {
    std::int32_t sum = 0;
    for (std::size_t k = 0; k < Descriptors::kSize; ++k) sum += row[k] * row[k];
    return sum;
}

/// Squared distance from a value that lacks the descriptor's own norm.
double squared_distance(std::int32_t value, std::int32_t own_norm) {
    return static_cast<double>(value) + static_cast<double>(own_norm);
}

bool passes_ratio(double best, std::int32_t second, std::int32_t own_norm,
                  double max_squared_ratio) {
    return second == kNoDistance || best < max_squared_ratio * squared_distance(second, own_norm);
}

std::vector<FeatureMatch> match_first(const Descriptors& a, std::size_t a_rows,
                                      const PackedDescriptors& b, std::size_t b_rows,
                                      const MatchOptions& options, DotKernel kernel) {
    std::vector<FeatureMatch> matches;
    if (a_rows == 0 || b_rows == 0) return matches;
    const auto [a_norms, of_a, of_b] = nearest_both_ways(
        std::span(a.values).first(a_rows * Descriptors::kSize), b, b_rows, kernel);
    const double max_squared_ratio = options.max_ratio * options.max_ratio;
    const double max_squared_distance = options.max_distance * options.max_distance * kUnit * kUnit;
    for (std::size_t i = 0; i < a_rows; ++i) {
        const std::size_t j = of_a.index[i];
        if (of_b.index[j] != i) continue;
        const double squared = squared_distance(of_a.best[i], a_norms[i]);
        if (squared <= max_squared_distance &&
            passes_ratio(squared, of_a.second[i], a_norms[i], max_squared_ratio) &&
            passes_ratio(squared, of_b.second[j], b.norms[j], max_squared_ratio)) {
            matches.push_back({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j)});
        }
    }
    return matches;
}

DotKernel fastest_kernel() {
    return available_dot_kernels().front().kernel;
}

}  // namespace

Result<void> validate(const MatchOptions& options) {
    if (!(options.max_ratio > 0.0 && options.max_ratio <= 1.0)) {
        return Error{ErrorCode::kInvalidArgument,
                     "matching: max_ratio must lie in (0, 1]; 0.8 is usual"};
    }
    if (!(options.max_distance > 0.0 && options.max_distance <= 2.0)) {
        return Error{ErrorCode::kInvalidArgument,
                     "matching: max_distance must lie in (0, 2]; 0.7 is usual"};
    }
    return {};
}

PackedDescriptors pack(const Descriptors& descriptors) {
    PackedDescriptors packed;
    packed.rows = descriptors.rows();
    packed.norms.resize(packed.rows);
    packed.strips.resize(strip_count(packed.rows));
    if (packed.rows % (kStripColumns * kStripGroup) != 0) {
        for (auto strip = packed.strips.end() - kStripGroup; strip != packed.strips.end();
             ++strip) {
            std::fill(std::begin(strip->bytes), std::end(strip->bytes), std::int8_t{-128});
        }
    }
    for (std::size_t j = 0; j < packed.rows; ++j) {
        const std::uint8_t* from = descriptors.row(j);
        packed.norms[j] = squared_norm(from);
        std::int8_t* to = packed.strips[j / kStripColumns].bytes + j % kStripColumns * 4;
        for (std::size_t k = 0; k < Descriptors::kSize; k += 4, to += 4 * kStripColumns) {
            // Flipping the top bit of a byte subtracts 128 in two's complement.
            std::uint32_t four = 0;
            std::memcpy(&four, from + k, sizeof(four));
            four ^= 0x80808080U;
            std::memcpy(to, &four, sizeof(four));
        }
    }
    return packed;
}

std::vector<FeatureMatch> match_with_kernel(const Descriptors& a, const PackedDescriptors& b,
                                            const MatchOptions& options, DotKernel kernel) {
    return match_first(a, a.rows(), b, b.rows, options, kernel);
}

std::vector<FeatureMatch> match_descriptors(const Descriptors& a, const PackedDescriptors& b,
                                            const MatchOptions& options) {
    return match_first(a, a.rows(), b, b.rows, options, fastest_kernel());
}

std::vector<FeatureMatch> match_descriptors(const Descriptors& a, const Descriptors& b,
                                            const MatchOptions& options) {
    return match_descriptors(a, pack(b), options);
}

std::size_t count_matches_of_strongest(const Descriptors& a, const PackedDescriptors& b,
                                       std::size_t count, const MatchOptions& options) {
    // Whole groups of strips: a kernel reads no column twice, and takes those past the end to be
    // zero.
    constexpr std::size_t kGroupColumns = kStripColumns * kStripGroup;
    const std::size_t rounded = (count + kGroupColumns - 1) / kGroupColumns * kGroupColumns;
    return match_first(a, std::min(a.rows(), rounded), b, std::min(b.rows, rounded), options,
                       fastest_kernel())
        .size();
}

}  // namespace psfm
