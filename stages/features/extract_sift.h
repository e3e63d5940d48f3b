// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

#include "graph/image.h"
#include "graph/result.h"
#include "stages/features/feature_options.h"

namespace psfm {

struct SiftFeatures {
    Keypoints keypoints;
    Descriptors descriptors;  ///< row i belongs to keypoint i
};

/// SIFT keypoints with RootSIFT descriptors (Lowe, IJCV 2004), by OpenCV's implementation.
/// Order: scale descending, then y, x, angle ascending; no two features agree in all four. A blob
/// with several orientations gives several features.
/// @param grey    8-bit, one channel
/// @param colour  8-bit BGR of the same size, for the features' colours
/// @return coordinates in the full image, origin at the top-left corner of the top-left pixel;
/// angles clockwise
///         from the x axis, 0 … 2 pi. No features is a success.
/// @errors kInvalidArgument (options, or images of the wrong kind), kInternal (OpenCV)
/// Deterministic for equal inputs, whatever OpenCV's number of threads. Thread-safe.
Result<SiftFeatures> extract_sift(const cv::Mat& grey, const cv::Mat& colour,
                                  const SiftOptions& options);

}  // namespace psfm
