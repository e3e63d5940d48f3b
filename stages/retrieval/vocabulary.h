// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "graph/image.h"
#include "stages/algorithms/matching/match_descriptors.h"
#include "stages/retrieval/word_tree.h"

namespace psfm {

/// A word tree made ready for assignment. Value; immutable, so threads may share it.
class Vocabulary {
  public:
    /// REQUIRES: tree.cells.rows() == tree.words.size(); each of words not empty.
    explicit Vocabulary(const WordTree& tree);

    std::size_t word_count() const { return first_word_.back(); }

    /// The word of each descriptor: the nearest word in the nearest cell.
    /// @return one number below word_count() a row, in the order of the rows. REQUIRES:
    /// word_count() > 0. Deterministic, the same bits on every processor. Thread-safe; uses the
    /// caller's TBB arena for the cells.
    std::vector<std::uint32_t> assign(std::span<const std::uint8_t> rows) const;

    /// xxHash64 of cells and words: equal for equal vocabularies.
    std::uint64_t content_hash() const { return content_hash_; }
    bool operator==(const Vocabulary& other) const { return content_hash_ == other.content_hash_; }

  private:
    PackedDescriptors cells_;
    std::vector<PackedDescriptors> words_;  ///< one entry a cell
    std::vector<std::uint32_t>
        first_word_;  ///< of each cell; the last entry is the number of words
    std::uint64_t content_hash_ = 0;
};

}  // namespace psfm
