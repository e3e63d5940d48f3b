// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/retrieval/train_vocabulary.h"

#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "stages/algorithms/matching/k_means.h"
#include "stages/algorithms/matching/nearest_rows.h"
#include "stages/algorithms/matching/rows_by_cell.h"
#include "stages/algorithms/math/in_parallel.h"

namespace psfm {

WordTree train_vocabulary(const Descriptors& sample, const TrainOptions& options) {
    WordTree tree;
    const std::size_t count = sample.rows();
    const std::size_t words = std::min(options.words, count);
    if (words == 0) return tree;
    const auto cells = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(words))));
    const std::uint64_t seed = XXH64(sample.values.data(), sample.values.size(), 0);
    tree.cells = k_means(sample.values, cells, options.iterations, seed);

    const auto cell_of_row = nearest_rows(sample.values, pack(tree.cells));
    const std::vector<CellRows> by_cell =
        rows_by_cell(sample.values, cell_of_row, tree.cells.rows());
    tree.words.resize(by_cell.size());  // k_means leaves no cell empty
    in_parallel(by_cell.size(), [&](std::size_t c) {
        const std::size_t rows = by_cell[c].rows.size();
        const std::size_t share = std::max<std::size_t>(1, (words * rows + count / 2) / count);
        tree.words[c] =
            k_means(by_cell[c].descriptors.values, share, options.iterations, seed + c + 1);
    });
    return tree;
}

}  // namespace psfm
