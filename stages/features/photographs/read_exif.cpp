// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/photographs/read_exif.h"

#include <cmath>
#include <exiv2/exiv2.hpp>
#include <string_view>

#include "stages/features/photographs/text.h"

namespace psfm {
namespace {

/// exiv2 0.28 has renamed it, and widened.
std::int64_t whole_number(const Exiv2::Exifdatum& datum, std::size_t n) {
#if EXIV2_TEST_VERSION(0, 28, 0)
    return datum.toInt64(n);
#else
    return datum.toLong(static_cast<long>(n));
#endif
}

/// The n-th value of a tag as a finite number. Zero denominators are no number.
std::optional<double> number(const Exiv2::ExifData& data, const char* key, long n = 0) {
    const auto found = data.findKey(Exiv2::ExifKey(key));
    if (found == data.end() || n >= static_cast<long>(found->count())) return std::nullopt;
    double value = 0.0;
    switch (found->typeId()) {
        case Exiv2::unsignedRational: {
            const Exiv2::Rational pair = found->toRational(n);
            value = static_cast<double>(static_cast<std::uint32_t>(pair.first)) /
                    static_cast<double>(static_cast<std::uint32_t>(pair.second));
            break;
        }
        case Exiv2::signedRational: {
            const Exiv2::Rational pair = found->toRational(n);
            value = static_cast<double>(pair.first) / static_cast<double>(pair.second);
            break;
        }
        case Exiv2::tiffFloat:
        case Exiv2::tiffDouble:
            value = static_cast<double>(found->toFloat(n));
            break;
        case Exiv2::unsignedByte:
        case Exiv2::unsignedShort:
        case Exiv2::unsignedLong:
        case Exiv2::signedByte:
        case Exiv2::signedShort:
        case Exiv2::signedLong:
            value = static_cast<double>(whole_number(*found, n));
            break;
        default:  // text and the like where a number belongs
            return std::nullopt;
    }
    if (!std::isfinite(value)) return std::nullopt;
    return value;
}

std::optional<double> positive(const Exiv2::ExifData& data, const char* key) {
    const std::optional<double> value = number(data, key);
    return value && *value > 0.0 ? value : std::nullopt;
}

/// Text up to the first zero byte, trimmed, on one line, valid UTF-8.
std::string text(const Exiv2::ExifData& data, const char* key) {
    constexpr std::size_t kMaxLength = 64;  // Guard: bounds what a file may say
    const auto found = data.findKey(Exiv2::ExifKey(key));
    if (found == data.end() || found->typeId() != Exiv2::asciiString) return {};
    std::string value = found->toString();
    value.resize(std::min(value.find('\0') == std::string::npos ? value.size() : value.find('\0'),
                          kMaxLength));
    for (char& c : value) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte < 0x20 || byte == 0x7F) c = ' ';
    }
    // Among valid UTF-8 there are control characters of two bytes, too.
    if (!is_valid_utf8(value) || has_control_characters(value)) {
        for (char& c : value) {
            if (static_cast<unsigned char>(c) >= 0x80) c = '?';
        }
    }
    const std::size_t first = value.find_first_not_of(' ');
    if (first == std::string::npos) return {};
    return value.substr(first, value.find_last_not_of(' ') - first + 1);
}

/// Pixels per millimetre of the sensor.
std::optional<double> focal_plane_resolution(const Exiv2::ExifData& data, const char* key) {
    const std::optional<double> resolution = positive(data, key);
    if (!resolution) return std::nullopt;
    // 1 means "none" and 2 inch; 4 and 5 are not in the standard, but cameras write them. It stays
    // a double: what claims to be a unit may be no int at all.
    const double unit = number(data, "Exif.Photo.FocalPlaneResolutionUnit").value_or(2.0);
    if (unit == 3.0) return *resolution / 10.0;
    if (unit == 4.0) return resolution;
    if (unit == 5.0) return *resolution * 1000.0;
    return *resolution / 25.4;
}

/// Degrees, minutes and seconds with their hemisphere. Minutes and seconds that are missing or have
/// a zero denominator count as zero: some writers put fractions into the degrees.
std::optional<double> angle_deg(const Exiv2::ExifData& data, const char* key,
                                const char* reference_key, std::string_view positive_reference,
                                std::string_view negative_reference) {
    const std::optional<double> degrees = number(data, key, 0);
    const std::string reference = text(data, reference_key);
    if (!degrees || *degrees < 0.0) return std::nullopt;
    if (reference != positive_reference && reference != negative_reference) return std::nullopt;
    const double minutes = number(data, key, 1).value_or(0.0);
    const double seconds = number(data, key, 2).value_or(0.0);
    if (minutes < 0.0 || minutes >= 60.0 + 1e-9 || seconds < 0.0 || seconds >= 60.0 + 1e-9)
        return std::nullopt;
    const double value = *degrees + minutes / 60.0 + seconds / 3600.0;
    return reference == negative_reference ? -value : value;
}

std::optional<GpsPosition> gps_position(const Exiv2::ExifData& data) {
    const auto latitude =
        angle_deg(data, "Exif.GPSInfo.GPSLatitude", "Exif.GPSInfo.GPSLatitudeRef", "N", "S");
    const auto longitude =
        angle_deg(data, "Exif.GPSInfo.GPSLongitude", "Exif.GPSInfo.GPSLongitudeRef", "E", "W");
    if (!latitude || !longitude || std::abs(*latitude) > 90.0 || std::abs(*longitude) > 180.0) {
        return std::nullopt;
    }
    if (*latitude == 0.0 && *longitude == 0.0) return std::nullopt;
    GpsPosition position{*latitude, *longitude, std::nullopt};
    constexpr double kDeepest = -12'000.0;  // Guard: [m] below any ocean floor
    constexpr double kHighest = 50'000.0;   // Guard: [m] above any balloon
    if (auto altitude = number(data, "Exif.GPSInfo.GPSAltitude")) {
        if (number(data, "Exif.GPSInfo.GPSAltitudeRef").value_or(0.0) == 1.0) altitude = -*altitude;
        if (*altitude > kDeepest && *altitude < kHighest) position.altitude_m = altitude;
    }
    return position;
}

bool tells_degrees(const Exiv2::ExifData& data) {
    const auto latitude = number(data, "Exif.GPSInfo.GPSLatitude", 0);
    const auto longitude = number(data, "Exif.GPSInfo.GPSLongitude", 0);
    return latitude && longitude && (*latitude != 0.0 || *longitude != 0.0);
}

ExifTags collect_tags(const Exiv2::ExifData& data) {
    ExifTags tags;
    tags.make = text(data, "Exif.Image.Make");
    tags.model = text(data, "Exif.Image.Model");
    const double orientation = number(data, "Exif.Image.Orientation").value_or(1.0);
    if (orientation >= 1.0 && orientation <= 8.0)
        tags.orientation = static_cast<std::uint8_t>(orientation);
    tags.focal_mm = positive(data, "Exif.Photo.FocalLength");
    tags.focal_35mm = positive(data, "Exif.Photo.FocalLengthIn35mmFilm");
    tags.focal_plane_x_per_mm = focal_plane_resolution(data, "Exif.Photo.FocalPlaneXResolution");
    tags.focal_plane_y_per_mm = focal_plane_resolution(data, "Exif.Photo.FocalPlaneYResolution");
    tags.digital_zoom = positive(data, "Exif.Photo.DigitalZoomRatio").value_or(1.0);
    tags.original_width = positive(data, "Exif.Photo.PixelXDimension");
    tags.original_height = positive(data, "Exif.Photo.PixelYDimension");
    tags.gps = gps_position(data);
    tags.has_impossible_position = !tags.gps && tells_degrees(data);
    return tags;
}

}  // namespace

ExifTags read_exif(std::span<const std::uint8_t> tiff) {
    if (tiff.empty()) return {};
    // Written once, before the first use in any thread; exiv2 has no other way to keep stderr
    // clean.
    [[maybe_unused]] static const bool is_silent = [] {
        Exiv2::LogMsg::setLevel(Exiv2::LogMsg::mute);
        return true;
    }();
    try {
        // The parser of bare EXIF data: exiv2's file readers also start its XMP toolkit, which is
        // not thread-safe.
        Exiv2::ExifData data;
        Exiv2::ExifParser::decode(data, tiff.data(), static_cast<std::uint32_t>(tiff.size()));
        return collect_tags(data);
    } catch (...) {  // not all that exiv2 throws derives from one class
        return {};
    }
}

}  // namespace psfm
