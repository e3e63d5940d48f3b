// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/matching/rows_by_cell.h"

#include <utility>

namespace psfm {

std::vector<CellRows> rows_by_cell(std::span<const std::uint8_t> rows,
                                   std::span<const std::uint32_t> cell_of_row, std::size_t cells) {
    constexpr std::size_t kSize = Descriptors::kSize;
    std::vector<CellRows> all(cells);
    for (std::size_t i = 0; i < cell_of_row.size(); ++i) {
        all[cell_of_row[i]].rows.push_back(static_cast<std::uint32_t>(i));
    }
    std::vector<CellRows> occupied;
    for (std::size_t c = 0; c < cells; ++c) {
        CellRows& cell = all[c];
        if (cell.rows.empty()) continue;
        cell.cell = c;
        cell.descriptors.values.reserve(cell.rows.size() * kSize);
        for (const std::uint32_t row : cell.rows) {
            const auto from = rows.subspan(row * kSize, kSize);
            cell.descriptors.values.insert(cell.descriptors.values.end(), from.begin(), from.end());
        }
        occupied.push_back(std::move(cell));
    }
    return occupied;
}

}  // namespace psfm
