// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "graph/image.h"

namespace psfm {

/// Visual words in a tree of two levels: cells of descriptor space, and words within each cell. Two
/// wide levels instead of the usual six narrow ones (Nister & Stewenius, CVPR 2006): the dot
/// kernels compare with 256 words in the time that branching would take to miss the cache.
struct WordTree {
    Descriptors cells;
    std::vector<Descriptors>
        words;  ///< one entry a cell, none of them empty; numbered on from cell to cell

    std::size_t word_count() const;
    bool operator==(const WordTree&) const = default;
};

}  // namespace psfm
