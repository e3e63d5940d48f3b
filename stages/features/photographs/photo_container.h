// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace psfm {

/// The file formats that are read.
enum class PhotoFormat { kJpeg, kPng, kTiff, kWebp, kBmp, kHeif, kJpeg2000, kPnm };

std::string_view format_name(PhotoFormat format);

struct PhotoSize {
    std::uint64_t width = 0;   ///< [px]
    std::uint64_t height = 0;  ///< [px]
};

/// What the structure of a file tells before any pixel is decoded. Made so that size limits hold
/// before memory is taken, and since decoders fill the missing part of a truncated file with grey,
/// in silence.
struct PhotoContainer {
    std::optional<PhotoSize> size;       ///< nothing when the header does not tell
    std::span<const std::uint8_t> exif;  ///< the TIFF structure of its EXIF data, or empty
    bool truncated = false;              ///< the file ends before its last part
};

/// Format by the first bytes (the extension plays no part); nothing for anything else.
std::optional<PhotoFormat> identify_format(std::span<const std::uint8_t> bytes);

/// Of a HEIF file: whether its pictures are coded as AV1, by its main brand.
bool is_avif(std::span<const std::uint8_t> bytes);

/// Walks the file's segments, chunks or boxes; reads nothing outside `bytes`, whatever they hold.
/// HEIF is left to libheif: only its format is known here.
/// @return views into `bytes`
PhotoContainer parse_container(PhotoFormat format, std::span<const std::uint8_t> bytes);

// One parser a family; each expects bytes that identify_format() gave to that format.
PhotoContainer parse_jpeg(std::span<const std::uint8_t> bytes);
PhotoContainer parse_png(std::span<const std::uint8_t> bytes);
PhotoContainer parse_webp(std::span<const std::uint8_t> bytes);
PhotoContainer parse_tiff(std::span<const std::uint8_t> bytes);
PhotoContainer parse_jpeg2000(std::span<const std::uint8_t> bytes);
PhotoContainer parse_bmp(std::span<const std::uint8_t> bytes);
PhotoContainer parse_pnm(std::span<const std::uint8_t> bytes);

}  // namespace psfm
