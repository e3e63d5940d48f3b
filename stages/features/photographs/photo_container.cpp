// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/photographs/photo_container.h"

#include <array>

#include "stages/features/photographs/byte_view.h"

namespace psfm {
namespace {

using std::string_view_literals::operator""sv;

/// ISO base media "ftyp" brands of still images that libheif reads.
constexpr std::array kHeifBrands{"heic"sv, "heix"sv, "heim"sv, "heis"sv, "hevc"sv, "hevx"sv,
                                 "mif1"sv, "mif2"sv, "msf1"sv, "avif"sv, "avis"sv};

bool is_heif(const ByteView& view) {
    if (!view.matches(4, "ftyp"sv)) return false;
    return std::any_of(kHeifBrands.begin(), kHeifBrands.end(),
                       [&](std::string_view brand) { return view.matches(8, brand); });
}

bool is_pnm(const ByteView& view) {
    const std::uint8_t kind = view.u8(1);
    const std::uint8_t space = view.u8(2);
    return view.u8(0) == 'P' && kind >= '1' && kind <= '6' &&
           (space == '\n' || space == ' ' || space == '\r' || space == '\t' || space == '#');
}

}  // namespace

std::string_view format_name(PhotoFormat format) {
    switch (format) {
        case PhotoFormat::kJpeg:
            return "JPEG";
        case PhotoFormat::kPng:
            return "PNG";
        case PhotoFormat::kTiff:
            return "TIFF";
        case PhotoFormat::kWebp:
            return "WebP";
        case PhotoFormat::kBmp:
            return "BMP";
        case PhotoFormat::kHeif:
            return "HEIF";
        case PhotoFormat::kJpeg2000:
            return "JPEG 2000";
        case PhotoFormat::kPnm:
            return "PNM";
    }
    return "image";
}

std::optional<PhotoFormat> identify_format(std::span<const std::uint8_t> bytes) {
    const ByteView view(bytes);
    if (view.matches(0, "\xFF\xD8\xFF"sv)) return PhotoFormat::kJpeg;
    if (view.matches(0, "\x89PNG\r\n\x1A\n"sv)) return PhotoFormat::kPng;
    if (view.matches(0, "II*\0"sv) || view.matches(0, "MM\0*"sv)) return PhotoFormat::kTiff;
    if (view.matches(0, "RIFF"sv) && view.matches(8, "WEBP"sv)) return PhotoFormat::kWebp;
    if (view.matches(0, "\0\0\0\x0CjP  \r\n\x87\n"sv)) return PhotoFormat::kJpeg2000;
    if (is_heif(view)) return PhotoFormat::kHeif;
    if (view.matches(0, "BM"sv) && view.le32(14) >= 12 && view.le32(14) <= 124)
        return PhotoFormat::kBmp;
    if (is_pnm(view)) return PhotoFormat::kPnm;
    return std::nullopt;
}

bool is_avif(std::span<const std::uint8_t> bytes) {
    const ByteView view(bytes);
    return view.matches(4, "ftypavif"sv) || view.matches(4, "ftypavis"sv);
}

PhotoContainer parse_container(PhotoFormat format, std::span<const std::uint8_t> bytes) {
    switch (format) {
        case PhotoFormat::kJpeg:
            return parse_jpeg(bytes);
        case PhotoFormat::kPng:
            return parse_png(bytes);
        case PhotoFormat::kTiff:
            return parse_tiff(bytes);
        case PhotoFormat::kWebp:
            return parse_webp(bytes);
        case PhotoFormat::kBmp:
            return parse_bmp(bytes);
        case PhotoFormat::kJpeg2000:
            return parse_jpeg2000(bytes);
        case PhotoFormat::kPnm:
            return parse_pnm(bytes);
        case PhotoFormat::kHeif:
            break;
    }
    return {};
}

}  // namespace psfm
