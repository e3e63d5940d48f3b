// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "graph/image.h"
#include "graph/result.h"
#include "stages/features/feature_options.h"
#include "stages/features/photographs/photo_file.h"

namespace psfm {

/// All that the other stages need of a photograph; its pixels are not kept.
struct ExtractedPhoto {
    PhotoMetadata metadata;
    Keypoints keypoints;
    Descriptors descriptors;                   ///< row i belongs to keypoint i
    std::vector<std::string> remarks = {};     ///< see DecodedPhoto
    std::vector<std::uint8_t> signature = {};  ///< see picture_signature
    std::uint64_t mask_hash = 0;               ///< of the mask file that was used; 0: none was
};

/// The features stage: reads one photograph, its EXIF data, its mask and focal prior, and extracts
/// SIFT features outside of the mask. A mask that cannot be used is a failure, since what it was to
/// hide would take part; without one a photograph takes part as a whole. A photograph without
/// features (a white wall) is a success: matching will find nothing in it.
/// @errors kUnreadable: for what the file is, no image, truncated, damaged, too small or too large;
///         kIo: the system does not let it be read, or its mask cannot be used; kInvalidArgument:
///         options; kInternal: a library failed, or memory is short. One line that names the
///         photograph and the remedy. No exception leaves this function.
/// Deterministic for equal bytes and options. Thread-safe; peak memory about 150 bytes a pixel of
/// the (reduced) photograph.
Result<ExtractedPhoto> run_features(const PhotoFile& photo, const FeatureOptions& options);

}  // namespace psfm
