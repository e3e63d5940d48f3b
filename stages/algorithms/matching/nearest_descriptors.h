// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "stages/algorithms/matching/match_descriptors.h"

namespace psfm {

/// Nearest neighbours of one side as dot_kernel.h's NearestTwo, which it describes.
struct NearestArrays {
    explicit NearestArrays(std::size_t count)
        : best(count, kNoDistance), second(count, kNoDistance), index(count, 0) {}

    /// Where a kernel writes those from `from` on.
    NearestTwo view(std::size_t from = 0) {
        return {best.data() + from, second.data() + from, index.data() + from};
    }

    std::vector<std::int32_t> best;
    std::vector<std::int32_t> second;
    std::vector<std::uint32_t> index;
};

/// One entry a descriptor.
struct RowSums {
    std::vector<std::int32_t> sums;   ///< of its bytes
    std::vector<std::int32_t> norms;  ///< squared
};
/// @param rows  descriptors of Descriptors::kSize bytes, one after another
RowSums sums_of(std::span<const std::uint8_t> rows);

struct NearestBothWays {
    RowSums row_sums;
    NearestArrays of_rows;
    NearestArrays of_columns;
};

/// Nearest and second nearest neighbours between all rows and all columns. REQUIRES: neither is
/// empty. Thread-safe.
NearestBothWays nearest_both_ways(std::span<const std::uint8_t> rows,
                                  const PackedDescriptors& columns, DotKernel kernel);

/// The nearest of `others` to each row, by exact Euclidean distance; the lowest index among equals.
/// @param rows  descriptors of Descriptors::kSize bytes, one after another
/// @return one index a row; empty when there are no rows
/// REQUIRES: others.rows > 0. Thread-safe; runs on the calling thread alone.
std::vector<std::uint32_t> nearest_descriptors(std::span<const std::uint8_t> rows,
                                               const PackedDescriptors& others);

}  // namespace psfm
