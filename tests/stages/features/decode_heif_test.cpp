// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/photographs/decode_heif.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <exiv2/exiv2.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "stages/features/photographs/read_photo.h"
#include "tests/stages/features/heif_fixture.h"
#include "tests/stages/features/photo_fixture.h"

namespace psfm {
namespace {

using testing::Bytes;

using testing::encode_heif;

TEST(DecodeHeifTest, ReadsPixelsAndExif) {
    Exiv2::ExifData data;
    data["Exif.Image.Make"] = "Heif Maker";
    Exiv2::Blob blob;
    Exiv2::ExifParser::encode(blob, Exiv2::littleEndian, data);
    const cv::Mat image = testing::textured_image(160, 128);
    const Bytes bytes = encode_heif(image, Bytes(blob.begin(), blob.end()));
    if (bytes.empty()) GTEST_SKIP() << "this libheif has no HEVC encoder";

    const testing::TemporaryFolder folder;
    const auto photo = read_photo(folder.write("phone.heic", bytes), {});
    ASSERT_TRUE(photo) << photo.error().message;
    ASSERT_EQ(photo->colour.size(), image.size());
    cv::Mat grey;
    cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
    EXPECT_LT(cv::norm(photo->grey, grey, cv::NORM_L1) / static_cast<double>(grey.total()), 4.0);
    EXPECT_EQ(photo->exif.make, "Heif Maker");
}

TEST(DecodeHeifTest, ReadsAvif) {
    const cv::Mat image = testing::textured_image(160, 128);
    const Bytes bytes = testing::encode_avif(image);
    if (bytes.empty()) GTEST_SKIP() << "this libheif has no AV1 encoder";
    const testing::TemporaryFolder folder;
    const auto photo = read_photo(folder.write("phone.avif", bytes), {});
    ASSERT_TRUE(photo) << photo.error().message;
    cv::Mat grey;
    cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
    ASSERT_EQ(photo->grey.size(), grey.size());
    EXPECT_LT(cv::norm(photo->grey, grey, cv::NORM_L1) / static_cast<double>(grey.total()), 4.0);
    EXPECT_TRUE(photo->mask.empty());
}

TEST(DecodeHeifTest, RefusesDamageAndSize) {
    Bytes bytes = encode_heif(testing::textured_image(160, 128), {});
    if (bytes.empty()) GTEST_SKIP() << "this libheif has no HEVC encoder";
    const testing::TemporaryFolder folder;
    const auto large = decode_heif(bytes, 1000.0);
    ASSERT_FALSE(large);
    EXPECT_THAT(large.error().message, ::testing::HasSubstr("above the limit"));
    bytes.resize(bytes.size() / 2);
    const auto half = read_photo(folder.write("half.heic", bytes), {});
    ASSERT_FALSE(half);
    EXPECT_EQ(half.error().code, ErrorCode::kUnreadable);
    EXPECT_THAT(half.error().message,
                ::testing::StartsWith("half.heic: cannot be decoded as HEIF"));
}

}  // namespace
}  // namespace psfm
