// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <exiv2/exiv2.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "stages/features/photographs/photo_container.h"
#include "tests/fuzz/seeds.h"
#include "tests/stages/features/heif_fixture.h"
#include "tests/stages/features/photo_fixture.h"

namespace psfm::fuzz {
namespace {

std::string_view text_of(std::span<const std::uint8_t> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

Exiv2::ExifData example_exif() {
    Exiv2::ExifData exif;
    exif["Exif.Image.Make"] = std::string("Maker");
    exif["Exif.Image.Model"] = std::string("Model 1");
    exif["Exif.Image.Orientation"] = std::uint16_t{6};
    exif["Exif.Photo.FocalLength"] = Exiv2::URational(35, 1);
    exif["Exif.Photo.FocalLengthIn35mmFilm"] = std::uint16_t{52};
    exif["Exif.Photo.FocalPlaneXResolution"] = Exiv2::URational(4000, 1);
    exif["Exif.Photo.FocalPlaneYResolution"] = Exiv2::URational(4000, 1);
    exif["Exif.Photo.FocalPlaneResolutionUnit"] = std::uint16_t{2};
    exif["Exif.Photo.PixelXDimension"] = std::uint32_t{72};
    exif["Exif.Photo.PixelYDimension"] = std::uint32_t{64};
    exif["Exif.GPSInfo.GPSLatitudeRef"] = std::string("N");
    exif["Exif.GPSInfo.GPSLatitude"] = std::string("48/1 22/1 3012/100");
    exif["Exif.GPSInfo.GPSLongitudeRef"] = std::string("W");
    exif["Exif.GPSInfo.GPSLongitude"] = std::string("7/1 56/1 1/2");
    exif["Exif.GPSInfo.GPSAltitudeRef"] = std::string("0");
    exif["Exif.GPSInfo.GPSAltitude"] = std::string("2103/10");
    return exif;
}

void write_photo(const SeedFolder& seeds, const std::string& name, const testing::Bytes& bytes) {
    for (const char* target : {"photo", "photo_header"}) {
        seeds.write(target, name, text_of(bytes));
    }
    const auto format = identify_format(bytes);
    if (!format || name.starts_with("plain")) return;
    seeds.write("exif", name, text_of(parse_container(*format, bytes).exif));
}

}  // namespace

void write_photo_seeds(const SeedFolder& seeds) {
    const cv::Mat noise = testing::textured_image(72, 64);
    cv::Mat flat;  // fewer bytes to change in vain
    cv::resize(noise, flat, {}, 1.0 / 16, 1.0 / 16, cv::INTER_AREA);
    cv::resize(flat, flat, noise.size(), 0, 0, cv::INTER_NEAREST);
    const Exiv2::ExifData exif = example_exif();
    for (const char* extension : {".jpg", ".png", ".tiff", ".webp", ".jp2"}) {
        const testing::Bytes plain = testing::encode(flat, extension);
        write_photo(seeds, std::string("plain") + extension, plain);
        write_photo(seeds, std::string("exif") + extension, testing::with_exif(plain, exif));
    }
    for (const char* extension : {".bmp", ".ppm"}) {
        write_photo(seeds, std::string("plain") + extension, testing::encode(flat, extension));
    }
    cv::Mat deep;
    flat.convertTo(deep, CV_16U, 257.0);
    write_photo(seeds, "plain_16.png", testing::encode(deep, ".png"));
    write_photo(seeds, "plain_16.tiff", testing::encode(deep, ".tiff"));
    Exiv2::Blob tiff;
    Exiv2::ExifParser::encode(tiff, Exiv2::littleEndian, exif);
    seeds.write("heif", "no_picture",
                std::string_view("\0\0\0\x10"
                                 "ftypheic\0\0\0\0",
                                 16));
    const testing::Bytes heif =
        testing::encode_heif(flat, testing::Bytes(tiff.begin(), tiff.end()));
    if (!heif.empty()) seeds.write("heif", "exif.heic", text_of(heif));  // Debian's has an encoder
}

}  // namespace psfm::fuzz
