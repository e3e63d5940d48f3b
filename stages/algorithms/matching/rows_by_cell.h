// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "graph/image.h"

namespace psfm {

/// The descriptors that fell into one cell, copied side by side for the dot kernels.
struct CellRows {
    std::size_t cell = 0;
    std::vector<std::uint32_t> rows;  ///< where they came from, ascending
    Descriptors descriptors;
};

/// Sorts descriptors by cell. @return one entry a cell that has any, ascending. Thread-safe.
std::vector<CellRows> rows_by_cell(std::span<const std::uint8_t> rows,
                                   std::span<const std::uint32_t> cell_of_row, std::size_t cells);

}  // namespace psfm
