// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

#include "graph/image.h"
#include "graph/result.h"
#include "stages/features/sift/sift_options.h"

namespace psfm {

struct SiftFeatures {
    Keypoints keypoints;
    Descriptors descriptors;  ///< row i belongs to keypoint i
};

/// SIFT keypoints with RootSIFT descriptors (Lowe, IJCV 2004): all extrema of contrast are found,
/// the largest are kept, and only those are described. The doubled image, which has three quarters
/// of the work, is looked at only where the image itself has fewer than max_features places.
/// Order: scale descending, then y, x, angle ascending; no two features agree in all four. A place
/// with several orientations gives several features.
/// @param grey    8-bit, one channel
/// @param colour  8-bit BGR of the same size, for the features' colours
/// @param mask    8-bit, one channel, of the same size: no feature lies where it is 0, and what is
///                kept is chosen from the others; empty: everywhere
/// @return coordinates in the full image, origin at the top-left corner of the top-left pixel;
/// angles clockwise
///         from the x axis, 0 … 2 pi. No features is a success.
/// @errors kInvalidArgument (options, or images of the wrong kind), kInternal (OpenCV)
/// Memory: options.strip_mib, and four bytes a pixel of the (reduced) image.
/// Deterministic for equal inputs, whatever OpenCV's number of threads. Thread-safe.
Result<SiftFeatures> extract_sift(const cv::Mat& grey, const cv::Mat& colour,
                                  const SiftOptions& options, const cv::Mat& mask = {});

}  // namespace psfm
