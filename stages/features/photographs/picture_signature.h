// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace psfm {

/// A photograph at a glance: grey values of kSignatureSide x kSignatureSide fields of equal size,
/// row by row, upright (EXIF orientation applied). is_reduced_copy() compares them. Thread-safe.
std::vector<std::uint8_t> picture_signature(const cv::Mat& grey, std::uint8_t orientation);

}  // namespace psfm
