// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/photographs/photo_container.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <random>

#include "tests/stages/features/photo_fixture.h"

namespace psfm {
namespace {

using testing::Bytes;
using testing::encode;
using testing::textured_image;

struct Format {
    const char* extension;
    PhotoFormat format;
};

class PhotoContainerTest : public ::testing::TestWithParam<Format> {};

TEST_P(PhotoContainerTest, TellsFormatAndSize) {
    const Bytes bytes = encode(textured_image(97, 71), GetParam().extension);
    ASSERT_EQ(identify_format(bytes), GetParam().format);
    const PhotoContainer container = parse_container(GetParam().format, bytes);
    ASSERT_TRUE(container.size);
    EXPECT_EQ(container.size->width, 97U);
    EXPECT_EQ(container.size->height, 71U);
    EXPECT_FALSE(container.truncated);
}

TEST_P(PhotoContainerTest, SeesEveryTruncation) {
    const Bytes bytes = encode(textured_image(97, 71), GetParam().extension);
    for (const double part : {0.3, 0.5, 0.9, 0.99}) {
        Bytes cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(
                                                     part * static_cast<double>(bytes.size())));
        EXPECT_TRUE(parse_container(GetParam().format, cut).truncated) << part;
    }
    // The last bytes of a TIFF may be anything that its directory points to, so one byte is not
    // always missed.
    if (GetParam().format == PhotoFormat::kTiff) return;
    const Bytes last(bytes.begin(), bytes.end() - 1);
    EXPECT_TRUE(parse_container(GetParam().format, last).truncated);
}

TEST_P(PhotoContainerTest, SurvivesAnyDamage) {
    const Bytes bytes = encode(textured_image(97, 71), GetParam().extension);
    std::mt19937 random(7);
    for (int i = 0; i < 2000; ++i) {
        Bytes damaged = bytes;
        const std::size_t header = std::min<std::size_t>(damaged.size(), 200);
        for (int k = 0; k < 4; ++k)
            damaged[random() % header] = static_cast<std::uint8_t>(random());
        damaged.resize(4 + random() % damaged.size());
        // The sanitizers watch; each format's own parser is called whatever the first bytes became.
        (void)parse_container(GetParam().format, damaged);
        (void)identify_format(damaged);
    }
}

INSTANTIATE_TEST_SUITE_P(
    Formats, PhotoContainerTest,
    ::testing::Values(Format{".jpg", PhotoFormat::kJpeg}, Format{".png", PhotoFormat::kPng},
                      Format{".tiff", PhotoFormat::kTiff}, Format{".webp", PhotoFormat::kWebp},
                      Format{".bmp", PhotoFormat::kBmp}, Format{".jp2", PhotoFormat::kJpeg2000},
                      Format{".ppm", PhotoFormat::kPnm}),
    [](const auto& param) { return std::string(param.param.extension + 1); });

TEST(PhotoContainerTest, ProgressiveAndRestartMarkedJpegsAreWhole) {
    const cv::Mat image = textured_image(200, 120);
    Bytes bytes;
    cv::imencode(".jpg", image, bytes,
                 {cv::IMWRITE_JPEG_PROGRESSIVE, 1, cv::IMWRITE_JPEG_RST_INTERVAL, 3});
    EXPECT_FALSE(parse_jpeg(bytes).truncated);
    bytes.resize(bytes.size() / 2);
    EXPECT_TRUE(parse_jpeg(bytes).truncated);
}

TEST(PhotoContainerTest, BytesAfterTheEndOfAJpegDoNotMatter) {
    Bytes bytes = encode(textured_image(80, 80), ".jpg");
    bytes.insert(bytes.end(), 1000, 0);  // as some phones append
    EXPECT_FALSE(parse_jpeg(bytes).truncated);
}

TEST(PhotoContainerTest, ZerosInPlaceOfTheSecondHalfAreTruncation) {
    Bytes bytes = encode(textured_image(80, 80), ".jpg");
    std::fill(bytes.begin() + static_cast<std::ptrdiff_t>(bytes.size() / 2), bytes.end(),
              std::uint8_t{0});
    EXPECT_TRUE(parse_jpeg(bytes).truncated);
}

TEST(PhotoContainerTest, ANameOfAWebpChunkMayBeABitstreamToItsDecoder) {
    Bytes bytes = encode(textured_image(72, 64), ".webp");
    const auto size_with_first_chunk = [&](const std::string& name) {
        std::copy(name.begin(), name.end(), bytes.begin() + 12);
        return *parse_webp(bytes).size;
    };
    const PhotoSize lossless = size_with_first_chunk("/P8X");
    EXPECT_EQ(lossless.width, 0x3850U + 1) << "14 bits after the first byte";
    const PhotoSize lossy = size_with_first_chunk("ABCD");
    EXPECT_EQ(lossy.width, (bytes[18] | (bytes[19] << 8U)) & 0x3FFFU);
}

TEST(PhotoContainerTest, NothingElseIsAnImage) {
    for (const std::string text :
         {"", "x", "hello world", "GIF89a...", "%PDF-1.4", "P7 no", "BMW is no bitmap at all"}) {
        const Bytes bytes(text.begin(), text.end());
        EXPECT_FALSE(identify_format(bytes)) << text;
    }
}

TEST(PhotoContainerTest, ReadsPnmHeadersWithComments) {
    const std::string text = "P5 # camera 7\n# two lines\n 12 10\n1023\n" + std::string(240, 'x');
    const Bytes bytes(text.begin(), text.end());
    const PhotoContainer container = parse_pnm(bytes);
    ASSERT_TRUE(container.size);
    EXPECT_EQ(container.size->width, 12U);
    EXPECT_EQ(container.size->height, 10U);
    EXPECT_FALSE(container.truncated);
    EXPECT_TRUE(parse_pnm(Bytes(bytes.begin(), bytes.end() - 1)).truncated);
}

// A header that tells a small size and hides a large one, for the decoder alone to find.

Bytes bytes_of(std::string_view text) {
    return {text.begin(), text.end()};
}

using std::string_view_literals::operator""sv;

TEST(PhotoContainerTest, TheFirstOfTwoPngHeadersCounts) {
    const Bytes bytes = bytes_of(
        "\x89PNG\r\n\x1A\n"
        "\0\0\0\x0DIHDR\0\0\x75\x30\0\0\x75\x30\x08\2\0\0\0crc."
        "\0\0\0\x0DIHDR\0\0\0\x50\0\0\0\x50\x08\2\0\0\0crc."
        "\0\0\0\0IENDcrc."sv);
    const auto container = parse_png(bytes);
    ASSERT_TRUE(container.size);
    EXPECT_EQ(container.size->width, 30000U);
    EXPECT_EQ(container.size->height, 30000U);
}

TEST(PhotoContainerTest, APnmCommentEndsAtACarriageReturn) {
    const auto container = parse_pnm(bytes_of("P6 #\r30000 30000 255\n80 80 255\n"));
    ASSERT_TRUE(container.size);
    EXPECT_EQ(container.size->width, 30000U);
    EXPECT_EQ(container.size->height, 30000U);
}

TEST(PhotoContainerTest, ATiffSizeIsTheFirstOneAndOfItsType) {
    const auto tiff = [](std::string_view width) {
        Bytes bytes = bytes_of("II*\0\x08\0\0\0\3\0"sv);
        bytes.insert(bytes.end(), width.begin(), width.end());
        for (const std::string_view entry :
             {"\0\1\3\0\1\0\0\0\x50\0\0\0"sv, "\1\1\3\0\1\0\0\0\x50\0\0\0"sv}) {
            bytes.insert(bytes.end(), entry.begin(), entry.end());
        }
        bytes.insert(bytes.end(), 4, std::uint8_t{0});
        bytes.insert(bytes.end(), {0x30, 0x75, 0, 0, 0, 0, 0, 0});  // at byte 50
        return parse_tiff(bytes).size.value_or(PhotoSize{}).width;
    };
    EXPECT_EQ(tiff("\0\1\3\0\1\0\0\0\x30\x75\0\0"sv), 30000U) << "SHORT, before another one";
    EXPECT_EQ(tiff("\0\1\x10\0\1\0\0\0\x32\0\0\0"sv), 30000U) << "LONG8 at byte 50";
    EXPECT_EQ(tiff("\0\1\1\0\1\0\0\0\x51\xFF\xFF\xFF"sv), 81U) << "BYTE";
}

TEST(PhotoContainerTest, AJpeg2000IsAsLargeAsItsCodestream) {
    Bytes bytes = encode(textured_image(97, 71), ".jp2");
    const Bytes size_marker = bytes_of("\xFF\x4F\xFF\x51"sv);
    const auto found =
        std::search(bytes.begin(), bytes.end(), size_marker.begin(), size_marker.end());
    ASSERT_NE(found, bytes.end());
    *(found + 10) = 0x75;  // the third byte of the width
    const auto container = parse_jpeg2000(bytes);
    ASSERT_TRUE(container.size);
    EXPECT_EQ(container.size->width, 0x7500U + 97U);
    EXPECT_EQ(container.size->height, 71U);
}

}  // namespace
}  // namespace psfm
