// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "graph/image.h"
#include "graph/result.h"

namespace psfm::synthetic {

/// The EXIF tags that a photograph carries; what is unset is not written.
struct PhotoExif {
    std::string make, model;                        ///< empty: not written
    std::optional<double> focal_mm = std::nullopt;  ///< FocalLength
    std::optional<std::uint16_t> focal_35mm;        ///< FocalLengthIn35mmFilm
    std::uint16_t orientation = 1;                  ///< 1 … 8
    std::optional<GpsPosition> gps = std::nullopt;
};

/// The JPEG with these tags instead of those it had.
/// @errors kUnreadable (not a JPEG), kInternal (exiv2's exception)
Result<std::vector<std::uint8_t>> add_exif(const std::vector<std::uint8_t>& jpeg,
                                           const PhotoExif& exif);

}  // namespace psfm::synthetic
