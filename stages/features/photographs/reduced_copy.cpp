// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/photographs/reduced_copy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

namespace psfm {
namespace {

constexpr std::size_t kFields = std::size_t{kSignatureSide} * kSignatureSide;

std::pair<double, double> upright_size(const Glance& photo) {
    const double width = photo.width;
    const double height = photo.height;
    return photo.orientation >= 5 ? std::pair(height, width) : std::pair(width, height);
}

using Fields = std::array<double, kFields>;

constexpr std::size_t field_at(int x, int y) {
    return static_cast<std::size_t>(y) * kSignatureSide + static_cast<std::size_t>(x);
}

/// Takes the mean of a row or column off it.
void center(Fields& fields, std::size_t first, std::size_t step) {
    double sum = 0.0;
    for (std::size_t i = 0; i < kSignatureSide; ++i) sum += fields[first + i * step];
    for (std::size_t i = 0; i < kSignatureSide; ++i)
        fields[first + i * step] -= sum / kSignatureSide;
}

/// What differs from its surroundings, and from its row and column: a sky above a plain is alike in
/// many photographs, what stands in it is not.
Fields details(std::span<const std::uint8_t> signature) {
    Fields result{};
    for (int y = 0; y < kSignatureSide; ++y) {
        for (int x = 0; x < kSignatureSide; ++x) {
            double sum = 0.0;
            int count = 0;
            for (int v = std::max(y - 1, 0); v <= std::min(y + 1, kSignatureSide - 1); ++v) {
                for (int u = std::max(x - 1, 0); u <= std::min(x + 1, kSignatureSide - 1); ++u) {
                    sum += signature[field_at(u, v)];
                    ++count;
                }
            }
            result[field_at(x, y)] = signature[field_at(x, y)] - sum / count;
        }
    }
    for (int line = 0; line < kSignatureSide; ++line) {  // horizons, and edges of buildings
        center(result, field_at(0, line), 1);
        center(result, field_at(line, 0), kSignatureSide);
    }
    return result;
}

/// Normalised correlation; 0 where one of the two varies by less than `least` [grey values].
double correlation(const Fields& a, const Fields& b, double least) {
    double sum_a = 0.0, sum_b = 0.0, sum_aa = 0.0, sum_bb = 0.0, sum_ab = 0.0;
    for (std::size_t i = 0; i < kFields; ++i) {
        sum_a += a[i];
        sum_b += b[i];
        sum_aa += a[i] * a[i];
        sum_bb += b[i] * b[i];
        sum_ab += a[i] * b[i];
    }
    const double n = kFields;
    const double variance_a = sum_aa / n - sum_a * sum_a / (n * n);
    const double variance_b = sum_bb / n - sum_b * sum_b / (n * n);
    if (variance_a < least * least || variance_b < least * least) return 0.0;
    return (sum_ab / n - sum_a * sum_b / (n * n)) / std::sqrt(variance_a * variance_b);
}

Fields values(std::span<const std::uint8_t> signature) {
    Fields result{};
    std::ranges::copy(signature, result.begin());
    return result;
}

}  // namespace

bool may_be_copy(const Glance& small, const Glance& large, const SmallCopyOptions& options) {
    /// Guard: sizes of previews are rounded: by a pixel of 64 at most. Ours.
    constexpr double kSameProportions = 0.02;
    const auto [small_width, small_height] = upright_size(small);
    const auto [large_width, large_height] = upright_size(large);
    if (std::min({small_width, small_height, large_width, large_height}) <= 0.0) return false;
    const double across = small_width / large_width;
    const double down = small_height / large_height;
    if (across > options.max_part || down > options.max_part) return false;
    return std::abs(across / down - 1.0) <= kSameProportions;
}

bool is_reduced_copy(const Glance& small, const Glance& large, const SmallCopyOptions& options) {
    if (!may_be_copy(small, large, options)) return false;
    if (small.signature.size() != kFields || large.signature.size() != kFields) return false;
    return correlation(values(small.signature), values(large.signature), options.min_contrast) >=
               options.min_correlation &&
           correlation(details(small.signature), details(large.signature), options.min_details) >=
               options.min_in_details;
}

}  // namespace psfm
