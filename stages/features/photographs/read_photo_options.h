// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "graph/result.h"

namespace psfm {

/// What counts as a photograph at all.
struct ReadPhotoOptions {
    /// Shorter sides are refused [px]. Raised: thumbnails people meant are refused; lowered: images
    /// that can hold no more than a handful of features take part. Ours; not tuned: two SIFT
    /// descriptor windows.
    std::uint32_t min_side_px = 64;
    /// Larger images are refused before they are decoded [megapixels]. Raised: one file can take
    /// 4 bytes a pixel of memory; lowered: large panoramas are refused. Ours; not tuned: above
    /// any camera's single exposure in 2026.
    double max_megapixels = 200.0;
    /// Longer files are refused [MiB]. Raised: one file can fill the memory; lowered: large
    /// uncompressed TIFFs are refused. Ours; not tuned: 200 megapixels of 16-bit RGB fit.
    std::uint32_t max_file_mib = 1200;
};

/// @errors kInvalidArgument, naming the field and its range
Result<void> validate(const ReadPhotoOptions& options);

}  // namespace psfm
