// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/photographs/read_exif.h"

#include <gtest/gtest.h>

#include <exiv2/exiv2.hpp>
#include <random>

#include "stages/features/photographs/photo_container.h"
#include "tests/stages/features/photo_fixture.h"

namespace psfm {
namespace {

using testing::Bytes;

Bytes encode_exif(const Exiv2::ExifData& data) {
    Exiv2::Blob blob;
    Exiv2::ExifParser::encode(blob, Exiv2::littleEndian, data);
    return {blob.begin(), blob.end()};
}

void set(Exiv2::ExifData& data, const char* key, Exiv2::TypeId type, const std::string& text) {
    const auto value = Exiv2::Value::create(type);
    value->read(text);
    data.add(Exiv2::ExifKey(key), value.get());
}

Exiv2::ExifData full_exif() {
    Exiv2::ExifData data;
    set(data, "Exif.Image.Make", Exiv2::asciiString, "  Canon ");
    set(data, "Exif.Image.Model", Exiv2::asciiString, "Canon PowerShot A10");
    set(data, "Exif.Image.Orientation", Exiv2::unsignedShort, "8");
    set(data, "Exif.Photo.FocalLength", Exiv2::unsignedRational, "173/32");
    set(data, "Exif.Photo.FocalLengthIn35mmFilm", Exiv2::unsignedShort, "35");
    set(data, "Exif.Photo.FocalPlaneXResolution", Exiv2::unsignedRational, "640000/206");
    set(data, "Exif.Photo.FocalPlaneYResolution", Exiv2::unsignedRational, "480000/155");
    set(data, "Exif.Photo.FocalPlaneResolutionUnit", Exiv2::unsignedShort, "2");
    set(data, "Exif.Photo.PixelXDimension", Exiv2::unsignedLong, "640");
    set(data, "Exif.Photo.PixelYDimension", Exiv2::unsignedShort, "480");
    set(data, "Exif.GPSInfo.GPSLatitudeRef", Exiv2::asciiString, "S");
    set(data, "Exif.GPSInfo.GPSLatitude", Exiv2::unsignedRational, "33/1 51/1 3540/100");
    set(data, "Exif.GPSInfo.GPSLongitudeRef", Exiv2::asciiString, "E");
    set(data, "Exif.GPSInfo.GPSLongitude", Exiv2::unsignedRational, "151/1 129/10 0/0");
    set(data, "Exif.GPSInfo.GPSAltitudeRef", Exiv2::unsignedByte, "1");
    set(data, "Exif.GPSInfo.GPSAltitude", Exiv2::unsignedRational, "25/2");
    return data;
}

TEST(ReadExifTest, ReadsAllTags) {
    const ExifTags tags = read_exif(encode_exif(full_exif()));
    EXPECT_EQ(tags.make, "Canon");
    EXPECT_EQ(tags.model, "Canon PowerShot A10");
    EXPECT_EQ(tags.orientation, 8);
    EXPECT_DOUBLE_EQ(tags.focal_mm.value(), 5.40625);
    EXPECT_DOUBLE_EQ(tags.focal_35mm.value(), 35.0);
    EXPECT_NEAR(tags.focal_plane_x_per_mm.value(), 640000.0 / 206.0 / 25.4, 1e-9);
    EXPECT_NEAR(tags.focal_plane_y_per_mm.value(), 480000.0 / 155.0 / 25.4, 1e-9);
    EXPECT_EQ(tags.original_width, 640.0);
    EXPECT_EQ(tags.original_height, 480.0);
    ASSERT_TRUE(tags.gps);
    EXPECT_NEAR(tags.gps->latitude_deg, -(33.0 + 51.0 / 60.0 + 35.4 / 3600.0), 1e-12);
    EXPECT_NEAR(tags.gps->longitude_deg, 151.0 + 12.9 / 60.0, 1e-12);
    EXPECT_EQ(tags.gps->altitude_m, -12.5);
}

TEST(ReadExifTest, ReadsExifOfEveryContainer) {
    const cv::Mat image = testing::textured_image(80, 64);
    for (const char* extension : {".jpg", ".webp", ".tiff", ".jp2"}) {
        const Bytes bytes = testing::with_exif(testing::encode(image, extension), full_exif());
        const auto format = identify_format(bytes);
        ASSERT_TRUE(format);
        const PhotoContainer container = parse_container(*format, bytes);
        EXPECT_FALSE(container.truncated) << extension;
        EXPECT_EQ(read_exif(container.exif).model, "Canon PowerShot A10") << extension;
    }
}

TEST(ReadExifTest, ReadsTheExifChunkOfPng) {
    // By hand: exiv2 0.27 still writes the older text profile.
    Bytes bytes = testing::encode(testing::textured_image(80, 64), ".png");
    const Bytes exif = encode_exif(full_exif());
    Bytes chunk{0, 0, static_cast<std::uint8_t>(exif.size() >> 8U),
                static_cast<std::uint8_t>(exif.size() & 0xFFU)};
    for (const char c : {'e', 'X', 'I', 'f'}) chunk.push_back(static_cast<std::uint8_t>(c));
    chunk.insert(chunk.end(), exif.begin(), exif.end());
    chunk.insert(chunk.end(), 4, 0);                               // checksum, not looked at
    bytes.insert(bytes.begin() + 33, chunk.begin(), chunk.end());  // behind the header chunk
    const PhotoContainer container = parse_png(bytes);
    EXPECT_FALSE(container.truncated);
    EXPECT_EQ(read_exif(container.exif).model, "Canon PowerShot A10");
}

TEST(ReadExifTest, UnitsOfTheFocalPlane) {
    const auto resolution = [](const char* unit) {
        Exiv2::ExifData data;
        set(data, "Exif.Photo.FocalPlaneXResolution", Exiv2::unsignedRational, "1000/1");
        if (unit != nullptr)
            set(data, "Exif.Photo.FocalPlaneResolutionUnit", Exiv2::unsignedShort, unit);
        return read_exif(encode_exif(data)).focal_plane_x_per_mm.value();
    };
    EXPECT_DOUBLE_EQ(resolution(nullptr), 1000.0 / 25.4);
    EXPECT_DOUBLE_EQ(resolution("1"), 1000.0 / 25.4);
    EXPECT_DOUBLE_EQ(resolution("2"), 1000.0 / 25.4);
    EXPECT_DOUBLE_EQ(resolution("3"), 100.0);
    EXPECT_DOUBLE_EQ(resolution("4"), 1000.0);
    EXPECT_DOUBLE_EQ(resolution("5"), 1e6);
}

TEST(ReadExifTest, AUnitThatIsNoWholeNumberIsUnknown) {
    const auto resolution = [](Exiv2::TypeId type, const char* unit) {
        Exiv2::ExifData data;
        set(data, "Exif.Photo.FocalPlaneXResolution", Exiv2::unsignedRational, "1000/1");
        set(data, "Exif.Photo.FocalPlaneResolutionUnit", type, unit);
        return read_exif(encode_exif(data)).focal_plane_x_per_mm.value();
    };
    // Beyond int, of which fuzzing made one: the conversion is undefined.
    EXPECT_DOUBLE_EQ(resolution(Exiv2::unsignedLong, "4000000000"), 1000.0 / 25.4);
    EXPECT_DOUBLE_EQ(resolution(Exiv2::tiffFloat, "1e30"), 1000.0 / 25.4);
    EXPECT_DOUBLE_EQ(resolution(Exiv2::unsignedRational, "7/2"), 1000.0 / 25.4);
    EXPECT_DOUBLE_EQ(resolution(Exiv2::unsignedRational, "3/1"), 100.0);
}

TEST(ReadExifTest, ImpossibleValuesAreAbsent) {
    Exiv2::ExifData data;
    set(data, "Exif.Image.Make", Exiv2::asciiString, "bad\x01\xFF name");
    set(data, "Exif.Image.Model", Exiv2::asciiString,
        "next\xC2\x85"
        "line");  // U+0085
    set(data, "Exif.Image.Orientation", Exiv2::unsignedShort, "77");
    set(data, "Exif.Photo.FocalLength", Exiv2::unsignedRational, "50/0");
    set(data, "Exif.Photo.FocalLengthIn35mmFilm", Exiv2::unsignedShort, "0");
    set(data, "Exif.Photo.FocalPlaneXResolution", Exiv2::unsignedRational, "0/0");
    set(data, "Exif.Photo.PixelXDimension", Exiv2::asciiString, "wide");
    set(data, "Exif.GPSInfo.GPSLatitudeRef", Exiv2::asciiString, "N");
    set(data, "Exif.GPSInfo.GPSLatitude", Exiv2::unsignedRational, "97/1 0/1 0/1");
    set(data, "Exif.GPSInfo.GPSLongitudeRef", Exiv2::asciiString, "E");
    set(data, "Exif.GPSInfo.GPSLongitude", Exiv2::unsignedRational, "10/1");
    const ExifTags tags = read_exif(encode_exif(data));
    EXPECT_EQ(tags.make, "bad ? name");
    EXPECT_EQ(tags.model, "next??line");
    EXPECT_EQ(tags.orientation, 1);
    EXPECT_FALSE(tags.focal_mm);
    EXPECT_FALSE(tags.focal_35mm);
    EXPECT_FALSE(tags.focal_plane_x_per_mm);
    EXPECT_FALSE(tags.original_width);
    EXPECT_FALSE(tags.gps);
    EXPECT_TRUE(tags.has_impossible_position);
}

TEST(ReadExifTest, DigitalZoom) {
    const auto zoom = [](const char* ratio) {
        Exiv2::ExifData data;
        data["Exif.Photo.FocalLength"] = Exiv2::Rational(54, 10);
        if (ratio != nullptr) data["Exif.Photo.DigitalZoomRatio"].setValue(ratio);
        return read_exif(encode_exif(data)).digital_zoom;
    };
    EXPECT_EQ(zoom("77/50"), 1.54);
    EXPECT_EQ(zoom("0/100"), 1.0);  // not used
    EXPECT_EQ(zoom("1/0"), 1.0);
    EXPECT_EQ(zoom(nullptr), 1.0);
}

TEST(ReadExifTest, NoFixAndNoHemisphereAreNoPosition) {
    Exiv2::ExifData data;
    set(data, "Exif.GPSInfo.GPSLatitude", Exiv2::unsignedRational, "0/1 0/1 0/1");
    set(data, "Exif.GPSInfo.GPSLongitude", Exiv2::unsignedRational, "0/1 0/1 0/1");
    EXPECT_FALSE(read_exif(encode_exif(data)).gps);
    set(data, "Exif.GPSInfo.GPSLatitudeRef", Exiv2::asciiString, "N");
    set(data, "Exif.GPSInfo.GPSLongitudeRef", Exiv2::asciiString, "E");
    EXPECT_FALSE(read_exif(encode_exif(data)).gps);
    EXPECT_FALSE(read_exif(encode_exif(data)).has_impossible_position) << "no fix";
    data["Exif.GPSInfo.GPSLatitude"] = Exiv2::URational(1, 1);
    EXPECT_TRUE(read_exif(encode_exif(data)).gps);
    EXPECT_FALSE(read_exif(encode_exif(data)).has_impossible_position);
    data["Exif.GPSInfo.GPSLatitudeRef"] = "?";
    EXPECT_TRUE(read_exif(encode_exif(data)).has_impossible_position);
}

TEST(ReadExifTest, SurvivesAnyDamage) {
    const Bytes bytes = encode_exif(full_exif());
    std::mt19937 random(3);
    for (int i = 0; i < 3000; ++i) {
        Bytes damaged = bytes;
        for (int k = 0; k < 6; ++k) {
            // Counts and types included: giant ones come up often.
            damaged[random() % damaged.size()] =
                static_cast<std::uint8_t>(random() % 2 == 0 ? 0xFF : random());
        }
        if (i % 3 == 0) damaged.resize(random() % damaged.size());
        const ExifTags tags = read_exif(damaged);
        EXPECT_GE(tags.orientation, 1);
        EXPECT_LE(tags.orientation, 8);
    }
    EXPECT_TRUE(read_exif({}).make.empty());
}

}  // namespace
}  // namespace psfm
