// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/retrieval/session_vocabulary.h"

#include <algorithm>

#include "stages/retrieval/train_vocabulary.h"

namespace psfm {

void append_spread(Descriptors& sample, const Descriptors& from, std::size_t rows,
                   std::size_t quota) {
    rows = std::min(rows, from.rows());
    const std::size_t taken = std::min(rows, quota);
    for (std::size_t i = 0; i < taken; ++i) {
        const std::uint8_t* row = from.row(i * rows / taken);
        sample.values.insert(sample.values.end(), row, row + Descriptors::kSize);
    }
}

Result<WordTree> train_session_vocabulary(std::uint32_t image_count, const DescriptorSource& source,
                                          const RetrievalOptions& options) {
    const std::size_t quota =
        std::max<std::size_t>(1, options.training_features / std::max(image_count, 1U));
    Descriptors sample;
    for (std::uint32_t i = 0; i < image_count; ++i) {
        const auto descriptors = source(ImageId{i});
        if (!descriptors.ok()) return descriptors.error();
        append_spread(sample, **descriptors, options.features_per_image, quota);
    }
    // A session of blank photographs still needs a vocabulary to go on with.
    if (sample.values.empty()) sample.values.resize(Descriptors::kSize);
    return train_vocabulary(
        sample, {.words = std::min(options.words_per_image * image_count, options.max_words),
                 .iterations = options.training_iterations});
}

}  // namespace psfm
