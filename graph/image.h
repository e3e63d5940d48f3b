// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "graph/ids.h"

namespace psfm {

/// WGS 84 position from EXIF.
struct GpsPosition {
    double latitude_deg = 0.0;
    double longitude_deg = 0.0;
    std::optional<double> altitude_m;
    bool operator==(const GpsPosition&) const = default;
};

/// What a photograph's file says of itself, before anything is matched.
struct PhotoMetadata {
    std::uint32_t width = 0;         ///< [px] as stored: EXIF orientation is *not* applied
    std::uint32_t height = 0;        ///< [px]
    std::uint64_t content_hash = 0;  ///< xxHash64 of the file's bytes
    std::string make;                ///< EXIF camera make and model, trimmed; empty when absent
    std::string model;
    std::optional<double> focal_px;  ///< focal length known from EXIF or Lensfun [px]
    std::optional<double> focal_mm;  ///< EXIF focal length [mm], as written
    double digital_zoom = 1.0;       ///< EXIF digital zoom ratio; 1 where it was not used
    /// The focal length is but a guess: EXIF has that of the photograph before it was cropped, or
    /// does not say whether digital zoom is in it.
    bool focal_is_vague = false;
    std::uint8_t orientation = 1;  ///< EXIF orientation 1..8: which side of the photograph was up
    std::optional<GpsPosition> gps;
    bool operator==(const PhotoMetadata&) const = default;
};

/// An accepted photograph of the session. Value; never changes after acceptance.
struct Image {
    ImageId id{};
    CameraId camera{};
    std::string name;  ///< relative to the photograph folder, '/' between parts
    PhotoMetadata metadata;
};

/// A detected feature. Coordinates have the origin at the top-left corner of the top-left pixel.
struct Keypoint {
    float x = 0.F;                              ///< [px]
    float y = 0.F;                              ///< [px]
    float scale = 0.F;                          ///< sigma of the blob [px]
    float angle = 0.F;                          ///< [rad]
    std::uint8_t red = 0, green = 0, blue = 0;  ///< colour of the photograph at the feature
    std::uint8_t padding = 0;

    Eigen::Vector2d position() const { return {x, y}; }
    bool operator==(const Keypoint&) const = default;
};

/// Features of one image, strongest (largest scale) first. Keypoint i belongs to row i of the
/// descriptors.
using Keypoints = std::vector<Keypoint>;

/// RootSIFT as bytes: row i holds round(512 * sqrt(SIFT_i / |SIFT|_1)), clamped to 255, 128 a row.
struct Descriptors {
    static constexpr std::size_t kSize = 128;  // Format: bytes of a SIFT descriptor
    std::vector<std::uint8_t> values;          ///< rows * kSize

    std::size_t rows() const { return values.size() / kSize; }
    const std::uint8_t* row(std::size_t i) const { return values.data() + i * kSize; }
    bool operator==(const Descriptors&) const = default;
};

}  // namespace psfm
