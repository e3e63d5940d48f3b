// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <span>

#include "graph/result.h"
#include "stages/features/photographs/photo_container.h"

namespace psfm {

struct DecodedPixels {
    cv::Mat colour;  ///< 8-bit BGR
    cv::Mat mask;    ///< 8-bit: 0 where it is transparent (mask_from_alpha); empty: nowhere
};

/// Pixels of any format but HEIF, through OpenCV, on the stored pixel grid, EXIF orientation not
/// applied. 10- to 16-bit images are scaled by their range:
/// the smallest of 10, 12, 14 and 16 bits that holds the largest value, since many writers leave
/// the upper bits of 16 unused.
/// @errors kUnreadable; the message is a reason and remedy without the file's name
/// Thread-safe.
Result<DecodedPixels> decode_pixels(std::span<const std::uint8_t> bytes, PhotoFormat format);

/// 16-bit values to 8 bits as decode_pixels() does. REQUIRES: depth CV_16U.
cv::Mat scale_to_8_bits(const cv::Mat& deep);

}  // namespace psfm
