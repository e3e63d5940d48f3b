// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

#include "graph/undistorted_view.h"

namespace psfm {

/// The picture of a view from its photograph, by bicubic interpolation; where the picture is less
/// than three quarters of the photograph's scale, from the photograph reduced by averaging over
/// areas, so that fine patterns do not turn into coarse ones. Places outside of the photograph are
/// black. Needs no more memory than photograph, picture, and a strip.
/// REQUIRES: photo is 8-bit BGR of view.photo's size
/// Deterministic, whatever OpenCV's number of threads. Thread-safe.
cv::Mat warp_photo(const cv::Mat& photo, const UndistortedView& view);

/// The same of a photograph's mask: 0 where a pixel of the picture is hidden for the most part, and
/// outside of the photograph, else 255. REQUIRES: visible is 8-bit, 0 or 255, of view.photo's size
cv::Mat warp_mask(const cv::Mat& visible, const UndistortedView& view);

}  // namespace psfm
