// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/retrieval/retrieval_options.h"

#include <string>

namespace psfm {
namespace {

struct Range {
    const char* name;
    std::size_t value;
    std::size_t low;
    std::size_t high;
};

}  // namespace

Result<void> validate(const RetrievalOptions& options) {
    constexpr std::size_t kMillion = 1000000;  // Guard: of typing errors
    const Range ranges[] = {
        {"candidates", options.candidates, 1, kMillion},
        {"features_per_image", options.features_per_image, 1, kMillion},
        {"words_per_image", options.words_per_image, 1, kMillion},
        {"max_words", options.max_words, 1, std::size_t{1} << 24U},
        {"training_features", options.training_features, 1, std::size_t{1} << 24U},
        {"max_training_images", options.max_training_images, 1, std::size_t{1} << 24U},
        {"training_iterations", options.training_iterations, 1, 1000},
        {"max_postings", options.max_postings, 1, std::size_t{1} << 40U},
    };
    for (const Range& range : ranges) {
        if (range.value < range.low || range.value > range.high) {
            return Error{ErrorCode::kInvalidArgument,
                         "retrieval: " + std::string(range.name) + " is " +
                             std::to_string(range.value) + "; it must lie in " +
                             std::to_string(range.low) + " to " + std::to_string(range.high)};
        }
    }
    if (!(options.vouched_part >= 0.0) || !(options.vouched_part <= 1.0))
        return Error{ErrorCode::kInvalidArgument, "retrieval: vouched_part must lie in 0 to 1"};
    if (!(options.vouched_beyond >= 0.0))
        return Error{ErrorCode::kInvalidArgument, "retrieval: vouched_beyond must not be negative"};
    return {};
}

}  // namespace psfm
