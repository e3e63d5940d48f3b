// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/matching/k_means.h"

#include <algorithm>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include "stages/algorithms/matching/nearest_rows.h"

namespace psfm {
namespace {

/// Distinct rows by a partial Fisher-Yates shuffle.
Descriptors random_rows(std::span<const std::uint8_t> rows, std::size_t count, std::uint64_t seed) {
    std::vector<std::uint32_t> order(rows.size() / Descriptors::kSize);
    std::iota(order.begin(), order.end(), 0U);
    std::mt19937_64 random(seed);
    Descriptors picked;
    picked.values.reserve(count * Descriptors::kSize);
    for (std::size_t i = 0; i < count; ++i) {
        std::swap(order[i], order[i + random() % (order.size() - i)]);
        const auto row = rows.subspan(order[i] * Descriptors::kSize, Descriptors::kSize);
        picked.values.insert(picked.values.end(), row.begin(), row.end());
    }
    return picked;
}

/// Mean of each centre's rows, rounded half up. A centre without rows stays where it was.
Descriptors means(std::span<const std::uint8_t> rows, const std::vector<std::uint32_t>& nearest,
                  const Descriptors& before) {
    std::vector<std::uint32_t> sums(before.values.size());
    std::vector<std::uint32_t> counts(before.rows());
    for (std::size_t i = 0; i < nearest.size(); ++i) {
        const std::uint8_t* row = rows.data() + i * Descriptors::kSize;
        std::uint32_t* sum = sums.data() + nearest[i] * Descriptors::kSize;
        for (std::size_t k = 0; k < Descriptors::kSize; ++k) sum[k] += row[k];
        ++counts[nearest[i]];
    }
    Descriptors out = before;
    for (std::size_t c = 0; c < counts.size(); ++c) {
        if (counts[c] == 0) continue;
        for (std::size_t k = c * Descriptors::kSize; k < (c + 1) * Descriptors::kSize; ++k) {
            out.values[k] = static_cast<std::uint8_t>((sums[k] + counts[c] / 2) / counts[c]);
        }
    }
    return out;
}

Descriptors without_empty(const Descriptors& centres, const std::vector<std::uint32_t>& nearest) {
    std::vector<bool> used(centres.rows());
    for (const std::uint32_t centre : nearest) used[centre] = true;
    Descriptors kept;
    for (std::size_t c = 0; c < centres.rows(); ++c) {
        if (used[c])
            kept.values.insert(kept.values.end(), centres.row(c),
                               centres.row(c) + Descriptors::kSize);
    }
    return kept;
}

}  // namespace

Descriptors k_means(std::span<const std::uint8_t> rows, std::size_t clusters, unsigned iterations,
                    std::uint64_t seed) {
    clusters = std::min(clusters, rows.size() / Descriptors::kSize);
    if (clusters == 0) return {};
    Descriptors centres = random_rows(rows, clusters, seed);
    std::vector<std::uint32_t> nearest = nearest_rows(rows, pack(centres));
    for (unsigned iteration = 0; iteration < iterations; ++iteration) {
        Descriptors moved = means(rows, nearest, centres);
        if (moved == centres) break;
        centres = std::move(moved);
        nearest = nearest_rows(rows, pack(centres));
    }
    // A dropped centre was the nearest of no row, so those that stay keep all of theirs.
    return without_empty(centres, nearest);
}

}  // namespace psfm
