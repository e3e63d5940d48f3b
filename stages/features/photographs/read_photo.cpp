// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/photographs/read_photo.h"

#include <xxhash.h>

#include <algorithm>
#include <cstdio>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>

#include "stages/features/photographs/decode_heif.h"
#include "stages/features/photographs/decode_pixels.h"
#include "stages/features/photographs/jpeg_completeness.h"
#include "stages/features/photographs/read_file_bytes.h"
#include "stages/features/photographs/text.h"

namespace psfm {
namespace {

std::string size_text(const PhotoSize& size) {
    return std::to_string(size.width) + "x" + std::to_string(size.height);
}

/// Why a photograph of this size is refused, if it is.
std::optional<std::string> size_fault(const PhotoSize& size, const ReadPhotoOptions& options) {
    if (std::min(size.width, size.height) < options.min_side_px) {
        return "is too small (" + size_text(size) + " pixels): features need at least " +
               std::to_string(options.min_side_px) + " pixels a side; leave it out";
    }
    const double megapixels =
        static_cast<double>(size.width) * static_cast<double>(size.height) / 1e6;
    // cv::Mat counts pixels of a side in int; a larger side is not in question within the limit.
    if (megapixels > options.max_megapixels) {
        char text[96];
        std::snprintf(text, sizeof text, " pixels, %.1f megapixels): the limit is %g megapixels",
                      megapixels, options.max_megapixels);
        return "is too large (" + size_text(size) + text + "; reduce it";
    }
    return std::nullopt;
}

std::string first_bytes(const std::vector<std::uint8_t>& bytes) {
    constexpr std::size_t kShown = 12;  // Format: bytes in a message
    return printable({reinterpret_cast<const char*>(bytes.data()), std::min(kShown, bytes.size())});
}

}  // namespace

Result<DecodedPhoto> read_photo(const PhotoFile& photo, const ReadPhotoOptions& options) {
    Result<std::vector<std::uint8_t>> read =
        read_file_bytes(photo, std::uint64_t{options.max_file_mib} << 20U);
    if (!read.ok()) return read.error();
    std::vector<std::uint8_t>& bytes = *read;

    const std::optional<PhotoFormat> format = identify_format(bytes);
    if (!format) {
        return unreadable(photo, "is not an image: its first bytes are \"" + first_bytes(bytes) +
                                     "\"; remove it, or export it as JPEG or PNG");
    }
    PhotoContainer container = parse_container(*format, bytes);
    if (container.size) {
        if (const auto fault = size_fault(*container.size, options))
            return unreadable(photo, *fault);
    }
    DecodedPhoto result;
    result.format = *format;
    result.content_hash = XXH64(bytes.data(), bytes.size(), 0);
    if (container.truncated && *format == PhotoFormat::kJpeg && mend_jpeg_end(bytes)) {
        result.remarks.push_back(printable(photo.name) +
                                 ": lacks the marker at its end, but all of its picture is there, "
                                 "and it is read; copy the file again if there is a better one");
        container = parse_container(*format, bytes);  // views into bytes that may have moved
    }
    if (container.truncated) {
        return unreadable(photo, "truncated: " + std::to_string(bytes.size()) + " bytes, " +
                                     std::string(format_name(*format)) +
                                     " ends in the middle; copy the file again");
    }

    if (*format == PhotoFormat::kHeif) {
        Result<HeifPhoto> heif = decode_heif(bytes, options.max_megapixels * 1e6);
        if (!heif.ok()) return unreadable(photo, heif.error().message);
        result.colour = heif->colour;
        result.mask = heif->mask;
        result.exif = read_exif(heif->exif);
    } else {
        Result<DecodedPixels> pixels = decode_pixels(bytes, *format);
        if (!pixels.ok()) return unreadable(photo, pixels.error().message);
        result.colour = pixels->colour;
        result.mask = pixels->mask;
        result.exif = read_exif(container.exif);
    }
    if (result.exif.has_impossible_position) {
        result.remarks.push_back(printable(photo.name) +
                                 ": its GPS position is no place on the earth, and is not used; "
                                 "mend its EXIF, or remove it");
    }
    // Again: not every header told the size.
    const PhotoSize size{static_cast<std::uint64_t>(result.colour.cols),
                         static_cast<std::uint64_t>(result.colour.rows)};
    if (const auto fault = size_fault(size, options)) return unreadable(photo, *fault);
    cv::cvtColor(result.colour, result.grey, cv::COLOR_BGR2GRAY);
    return result;
}

}  // namespace psfm
