// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "graph/image.h"
#include "graph/result.h"
#include "stages/features/feature_options.h"
#include "stages/features/photo_file.h"

namespace psfm {

/// All that the other stages need of a photograph; its pixels are not kept.
struct ExtractedPhoto {
    PhotoMetadata metadata;
    Keypoints keypoints;
    Descriptors descriptors;  ///< row i belongs to keypoint i
};

/// The features stage: reads one photograph, its EXIF data and focal prior, and extracts SIFT
/// features. A photograph without features (a white wall) is a success: matching will find nothing
/// in it.
/// @errors kUnreadable: for what the file is, no image, truncated, damaged, too small or too large;
///         kIo: the system does not let it be read; kInvalidArgument: options; kInternal: a library
///         failed, or memory is short. One line that names the photograph and the remedy. No
///         exception leaves this function.
/// Deterministic for equal bytes and options. Thread-safe; peak memory about 150 bytes a pixel of
/// the (reduced) photograph.
Result<ExtractedPhoto> run_features(const PhotoFile& photo, const FeatureOptions& options);

}  // namespace psfm
