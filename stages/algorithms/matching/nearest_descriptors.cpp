// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/matching/nearest_descriptors.h"

#include <cassert>
#include <utility>

namespace psfm {

RowSums sums_of(std::span<const std::uint8_t> rows) {
    const std::size_t count = rows.size() / Descriptors::kSize;
    RowSums of{std::vector<std::int32_t>(count), std::vector<std::int32_t>(count)};
    available_dot_kernels().front().row_sums(rows.data(), count, of.sums.data(), of.norms.data());
    return of;
}

NearestBothWays nearest_both_ways(std::span<const std::uint8_t> rows,
                                  const PackedDescriptors& columns, DotKernel kernel) {
    const std::size_t row_count = rows.size() / Descriptors::kSize;
    const std::size_t column_count = columns.rows;
    assert(row_count > 0 && column_count > 0);
    NearestBothWays nearest{sums_of(rows), NearestArrays(row_count), NearestArrays(column_count)};
    std::vector<StripKeys> column_keys(strip_count(column_count));
    std::vector<LaneMinima> column_minima(strip_count(column_count));
    const DotKernelInput input{.rows = rows.data(),
                               .row_norms = nearest.row_sums.norms.data(),
                               .row_sums = nearest.row_sums.sums.data(),
                               .row_count = row_count,
                               .strips = columns.strips.data(),
                               .column_norms = columns.norms.data(),
                               .column_count = column_count};
    kernel(input, {.of_rows = nearest.of_rows.view(),
                   .of_columns = nearest.of_columns.view(),
                   .column_keys = column_keys.data(),
                   .column_minima = column_minima.data()});
    return nearest;
}

std::vector<std::uint32_t> nearest_descriptors(std::span<const std::uint8_t> rows,
                                               const PackedDescriptors& others) {
    if (rows.empty()) return {};
    const DotKernel kernel = available_dot_kernels().front().kernel;
    return std::move(nearest_both_ways(rows, others, kernel).of_rows.index);
}

}  // namespace psfm
