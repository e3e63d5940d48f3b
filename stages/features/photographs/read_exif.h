// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "graph/image.h"

namespace psfm {

/// The tags of EXIF (CIPA DC-008) that reconstruction can use. What is absent, malformed or
/// impossible is absent.
struct ExifTags {
    std::string make;              ///< trimmed, one line of UTF-8, at most 64 bytes
    std::string model;             ///< likewise
    std::uint8_t orientation = 1;  ///< 1 … 8
    std::optional<double> focal_mm;
    std::optional<double> focal_35mm;  ///< FocalLengthIn35mmFilm [mm]
    std::optional<double>
        focal_plane_x_per_mm;  ///< FocalPlaneXResolution [px of the original / mm]
    std::optional<double> focal_plane_y_per_mm;
    double digital_zoom = 1.0;  ///< DigitalZoomRatio; 1 where it is 0, which means "not used"
    /// PixelXDimension, PixelYDimension: the size when the photograph was taken [px]. Editors that
    /// reduce a photograph often leave them as they were.
    std::optional<double> original_width;
    std::optional<double> original_height;
    std::optional<GpsPosition> gps;  ///< nothing for (0, 0), which cameras without a fix write
    /// There are degrees of latitude and longitude, not (0, 0), that are no place on the earth, or
    /// lack their hemispheres.
    bool has_impossible_position = false;
};

/// Reads a TIFF structure as found in EXIF. Never fails: damaged data give what could be read, or
/// nothing. Thread-safe. exiv2's messages on stderr are switched off for the process.
ExifTags read_exif(std::span<const std::uint8_t> tiff);

}  // namespace psfm
