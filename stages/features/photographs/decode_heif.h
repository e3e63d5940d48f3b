// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

#include "graph/result.h"
#include "stages/features/photographs/photo_container.h"

namespace psfm {

struct HeifPhoto {
    cv::Mat colour;                  ///< 8-bit BGR
    cv::Mat mask;                    ///< 8-bit: 0 where it is transparent; empty: nowhere
    std::vector<std::uint8_t> exif;  ///< TIFF structure, or empty
};

/// The primary picture of a HEIF or AVIF file. Its rotation and mirroring are part of the picture
/// (ISO 23008-12, 6.5.10: derived by every reader), so they are applied, and EXIF's orientation
/// then counts for nothing.
/// @param max_pixels checked before pixels are decoded
/// @errors kUnreadable; the message is a reason and remedy without the file's name
/// Thread-safe.
Result<HeifPhoto> decode_heif(std::span<const std::uint8_t> bytes, double max_pixels);

/// Whether libheif has a decoder of HEVC, which HEIC photographs are: Debian 13 has it in a package
/// of its own. Thread-safe.
bool can_decode_heif();

}  // namespace psfm
