// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/retrieval/word_tree.h"

namespace psfm {

std::size_t WordTree::word_count() const {
    std::size_t count = 0;
    for (const Descriptors& of_cell : words) count += of_cell.rows();
    return count;
}

}  // namespace psfm
