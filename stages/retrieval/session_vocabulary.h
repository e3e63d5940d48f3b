// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "stages/retrieval/retrieval_options.h"
#include "stages/retrieval/retrieval_state.h"

namespace psfm {

/// A vocabulary from images 0 … image_count - 1: options.words_per_image words for each of them,
/// from options.training_features descriptors spread evenly over the images, and over the features
/// of each. At least one word comes back even when no image has features.
/// @errors those of `source`. Deterministic. Memory: options.training_features * 256 bytes.
Result<WordTree> train_session_vocabulary(std::uint32_t image_count, const DescriptorSource& source,
                                          const RetrievalOptions& options);

/// Appends at most `quota` rows of the first `rows` of `from` to `sample`, evenly spread.
void append_spread(Descriptors& sample, const Descriptors& from, std::size_t rows,
                   std::size_t quota);

}  // namespace psfm
