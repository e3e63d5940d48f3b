// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/retrieval/vocabulary.h"

#include <xxhash.h>

#include "stages/algorithms/matching/nearest_descriptors.h"
#include "stages/algorithms/matching/nearest_rows.h"
#include "stages/algorithms/matching/rows_by_cell.h"

namespace psfm {

Vocabulary::Vocabulary(const WordTree& tree)
    : cells_(pack(tree.cells)),
      first_word_{0},
      content_hash_(XXH64(tree.cells.values.data(), tree.cells.values.size(), tree.cells.rows())) {
    for (const Descriptors& of_cell : tree.words) {
        words_.push_back(pack(of_cell));
        first_word_.push_back(first_word_.back() + static_cast<std::uint32_t>(of_cell.rows()));
        content_hash_ = XXH64(of_cell.values.data(), of_cell.values.size(), content_hash_);
    }
}

std::vector<std::uint32_t> Vocabulary::assign(std::span<const std::uint8_t> rows) const {
    const std::vector<std::uint32_t> cell_of_row = nearest_rows(rows, cells_);
    std::vector<std::uint32_t> words(cell_of_row.size());
    for (const CellRows& cell : rows_by_cell(rows, cell_of_row, cells_.rows)) {
        const auto nearest = nearest_descriptors(cell.descriptors.values, words_[cell.cell]);
        for (std::size_t i = 0; i < nearest.size(); ++i) {
            words[cell.rows[i]] = first_word_[cell.cell] + nearest[i];
        }
    }
    return words;
}

}  // namespace psfm
