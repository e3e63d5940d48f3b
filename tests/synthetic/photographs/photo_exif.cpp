// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/synthetic/photographs/photo_exif.h"

#include <array>
#include <cmath>
#include <exiv2/exiv2.hpp>

namespace psfm::synthetic {
namespace {

Exiv2::URationalValue rational(double value, std::uint32_t denominator) {
    return Exiv2::URationalValue(
        {static_cast<std::uint32_t>(std::llround(value * denominator)), denominator});
}

/// Degrees, minutes and seconds to 1e-6 of a second (0.03 mm).
Exiv2::URationalValue degrees_minutes_seconds(double angle_deg) {
    const double degrees = std::floor(angle_deg);
    const double minutes = std::floor((angle_deg - degrees) * 60.0);
    const double seconds = ((angle_deg - degrees) * 60.0 - minutes) * 60.0;
    Exiv2::URationalValue value;
    value.value_.push_back({static_cast<std::uint32_t>(degrees), 1});
    value.value_.push_back({static_cast<std::uint32_t>(minutes), 1});
    value.value_.push_back({static_cast<std::uint32_t>(std::llround(seconds * 1e6)), 1000000});
    return value;
}

void set_gps(const GpsPosition& gps, Exiv2::ExifData& data) {
    data["Exif.GPSInfo.GPSVersionID"] = "2 3 0 0";
    data["Exif.GPSInfo.GPSLatitudeRef"] = gps.latitude_deg < 0.0 ? "S" : "N";
    data["Exif.GPSInfo.GPSLatitude"].setValue(
        std::make_unique<Exiv2::URationalValue>(degrees_minutes_seconds(std::abs(gps.latitude_deg)))
            .get());
    data["Exif.GPSInfo.GPSLongitudeRef"] = gps.longitude_deg < 0.0 ? "W" : "E";
    const Exiv2::URationalValue longitude = degrees_minutes_seconds(std::abs(gps.longitude_deg));
    data["Exif.GPSInfo.GPSLongitude"].setValue(&longitude);
    if (!gps.altitude_m) return;
    const Exiv2::URationalValue altitude = rational(std::abs(*gps.altitude_m), 1000);
    data["Exif.GPSInfo.GPSAltitude"].setValue(&altitude);
    const std::array<Exiv2::byte, 1> below_sea{
        static_cast<Exiv2::byte>(*gps.altitude_m < 0.0 ? 1 : 0)};
    Exiv2::DataValue reference(below_sea.data(), 1, Exiv2::invalidByteOrder, Exiv2::unsignedByte);
    data["Exif.GPSInfo.GPSAltitudeRef"].setValue(&reference);
}

Exiv2::ExifData tags(const PhotoExif& exif) {
    Exiv2::ExifData data;
    if (!exif.make.empty()) data["Exif.Image.Make"] = exif.make;
    if (!exif.model.empty()) data["Exif.Image.Model"] = exif.model;
    data["Exif.Image.Orientation"] = exif.orientation;
    if (exif.focal_mm) {
        const Exiv2::URationalValue focal = rational(*exif.focal_mm, 1000);
        data["Exif.Photo.FocalLength"].setValue(&focal);
    }
    if (exif.focal_35mm) data["Exif.Photo.FocalLengthIn35mmFilm"] = *exif.focal_35mm;
    if (exif.gps) set_gps(*exif.gps, data);
    return data;
}

}  // namespace

Result<std::vector<std::uint8_t>> add_exif(const std::vector<std::uint8_t>& jpeg,
                                           const PhotoExif& exif) {
    try {
        const auto image = Exiv2::ImageFactory::open(jpeg.data(), static_cast<long>(jpeg.size()));
        image->setExifData(tags(exif));
        image->writeMetadata();
        Exiv2::BasicIo& io = image->io();
        std::vector<std::uint8_t> result(io.size());
        io.open();
        io.seek(0, Exiv2::BasicIo::beg);
        io.read(result.data(), static_cast<long>(result.size()));
        io.close();
        return result;
    } catch (const Exiv2::Error& error) {
        return Error{jpeg.empty() ? ErrorCode::kUnreadable : ErrorCode::kInternal,
                     std::string("EXIF cannot be added to this JPEG: ") + error.what()};
    }
}

}  // namespace psfm::synthetic
