// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/feature_options.h"

#include <initializer_list>
#include <string>

namespace psfm {
namespace {

struct Range {
    const char* name;
    double value;
    double low;
    double high;
};

/// Comparisons are written so that NaN fails.
Result<void> check_ranges(std::initializer_list<Range> ranges) {
    for (const Range& range : ranges) {
        if (range.value >= range.low && range.value <= range.high) continue;
        return Error{ErrorCode::kInvalidArgument,
                     std::string(range.name) + " is " + std::to_string(range.value) +
                         "; give a value from " + std::to_string(range.low) + " to " +
                         std::to_string(range.high)};
    }
    return {};
}

}  // namespace

Result<void> validate(const ReadPhotoOptions& options) {
    return check_ranges({{"min_side_px", static_cast<double>(options.min_side_px), 16, 1e5},
                         // OpenCV refuses more than 2^30 pixels by itself.
                         {"max_megapixels", options.max_megapixels, 0.001, 1000},
                         {"max_file_mib", static_cast<double>(options.max_file_mib), 1, 8192}});
}

Result<void> validate(const SiftOptions& options) {
    return check_ranges({{"max_image_size", static_cast<double>(options.max_image_size), 64, 30000},
                         {"max_features", static_cast<double>(options.max_features), 1, 1e6},
                         {"max_orientations", static_cast<double>(options.max_orientations), 1, 36},
                         {"octave_layers", static_cast<double>(options.octave_layers), 1, 10},
                         {"contrast_threshold", options.contrast_threshold, 1e-4, 1},
                         {"edge_threshold", options.edge_threshold, 1.01, 1000},
                         {"sigma", options.sigma, 1.01, 10},
                         {"strip_mib", static_cast<double>(options.strip_mib), 1, 65536}});
}

Result<void> validate(const FeatureOptions& options) {
    if (Result<void> read = validate(options.read); !read) return read;
    return validate(options.sift);
}

}  // namespace psfm
