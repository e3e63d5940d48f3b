// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "graph/image.h"
#include "stages/retrieval/vocabulary.h"

namespace psfm {

struct TrainOptions {
    /// Words wanted, at most 2^24. More: finer, shorter lists a word, but descriptors of one point
    /// fall apart when the training data cannot support them. Every word needs at least one
    /// training descriptor.
    std::size_t words = 65536;
    /// Iterations of k-means at each level. More: training takes longer for slightly tighter words.
    /// Ours; not tuned.
    unsigned iterations = 8;
};

/// Hierarchical k-means: sqrt(words) cells, then words in each cell in proportion to its
/// descriptors. Seeds come from the descriptors' content.
/// @return fewer words than wanted when there are fewer distinct descriptors; none for no
/// descriptors Deterministic, the same bits on every processor and number of threads. Thread-safe;
/// uses the caller's TBB arena. Memory: twice the descriptors.
WordTree train_vocabulary(const Descriptors& sample, const TrainOptions& options);

}  // namespace psfm
