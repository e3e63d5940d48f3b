// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/photographs/read_photo.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <xxhash.h>

#include <exiv2/exiv2.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "tests/stages/features/photo_fixture.h"

namespace psfm {
namespace {

using ::testing::AllOf;
using testing::Bytes;
using testing::encode;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
using testing::TemporaryFolder;
using testing::textured_image;

class ReadPhotoTest : public ::testing::Test {
  protected:
    /// The message of a refusal, checked for code, name and form.
    std::string refusal(const PhotoFile& photo, const ReadPhotoOptions& options = {},
                        ErrorCode code = ErrorCode::kUnreadable) {
        const Result<DecodedPhoto> result = read_photo(photo, options);
        if (result) return "was read";
        EXPECT_EQ(result.error().code, code);
        EXPECT_THAT(result.error().message, StartsWith(photo.name + ": "));
        EXPECT_THAT(result.error().message, Not(HasSubstr("\n")));
        return result.error().message;
    }

    TemporaryFolder folder_;
};

TEST_F(ReadPhotoTest, ReadsEveryFormatLosslesslyWhereItIs) {
    const cv::Mat image = textured_image(120, 80);
    for (const char* extension : {".png", ".tiff", ".bmp", ".ppm"}) {
        const auto photo =
            read_photo(folder_.write(std::string("a") + extension, encode(image, extension)), {});
        ASSERT_TRUE(photo) << photo.error().message;
        EXPECT_EQ(cv::norm(photo->colour, image, cv::NORM_INF), 0.0) << extension;
    }
    for (const char* extension : {".jpg", ".webp", ".jp2"}) {
        const auto photo =
            read_photo(folder_.write(std::string("a") + extension, encode(image, extension)), {});
        ASSERT_TRUE(photo) << photo.error().message;
        EXPECT_EQ(photo->colour.size(), image.size());
        EXPECT_LT(cv::norm(photo->colour, image, cv::NORM_L1) /
                      (3.0 * static_cast<double>(image.total())),
                  8.0)
            << extension;
    }
}

TEST_F(ReadPhotoTest, HashesTheBytes) {
    const Bytes bytes = encode(textured_image(80, 80), ".png");
    const auto photo = read_photo(folder_.write("a.png", bytes), {});
    ASSERT_TRUE(photo);
    EXPECT_EQ(photo->content_hash, XXH64(bytes.data(), bytes.size(), 0));
}

TEST_F(ReadPhotoTest, DoesNotTurnThePixels) {
    Exiv2::ExifData exif;
    exif["Exif.Image.Orientation"] = std::uint16_t{6};
    const cv::Mat image = textured_image(160, 96);
    const Bytes plain = encode(image, ".jpg");
    const auto turned = read_photo(folder_.write("a.jpg", testing::with_exif(plain, exif)), {});
    const auto upright = read_photo(folder_.write("b.jpg", plain), {});
    ASSERT_TRUE(turned);
    ASSERT_TRUE(upright);
    EXPECT_EQ(turned->exif.orientation, 6);
    ASSERT_EQ(turned->colour.size(), image.size());
    EXPECT_EQ(cv::norm(turned->colour, upright->colour, cv::NORM_INF), 0.0);
}

TEST_F(ReadPhotoTest, Scales16BitGrey) {
    cv::Mat grey;
    cv::cvtColor(textured_image(100, 90), grey, cv::COLOR_BGR2GRAY);
    cv::Mat deep;
    grey.convertTo(deep, CV_16U, 257.0);
    const auto photo = read_photo(folder_.write("deep.png", encode(deep, ".png")), {});
    ASSERT_TRUE(photo) << photo.error().message;
    EXPECT_EQ(photo->colour.type(), CV_8UC3);
    EXPECT_EQ(cv::norm(photo->grey, grey, cv::NORM_INF), 0.0);
}

TEST_F(ReadPhotoTest, Scales12BitsStoredIn16) {
    cv::Mat grey;
    cv::cvtColor(textured_image(100, 90), grey, cv::COLOR_BGR2GRAY);
    cv::Mat deep;
    grey.convertTo(deep, CV_16U, 4095.0 / 255.0);
    const auto photo = read_photo(folder_.write("deep.tif", encode(deep, ".tif")), {});
    ASSERT_TRUE(photo) << photo.error().message;
    EXPECT_LE(cv::norm(photo->grey, grey, cv::NORM_INF), 1.0);
}

TEST_F(ReadPhotoTest, DropsTransparency) {
    cv::Mat image = textured_image(80, 70);
    cv::Mat with_alpha;
    cv::cvtColor(image, with_alpha, cv::COLOR_BGR2BGRA);
    const auto photo = read_photo(folder_.write("a.png", encode(with_alpha, ".png")), {});
    ASSERT_TRUE(photo) << photo.error().message;
    EXPECT_EQ(cv::norm(photo->colour, image, cv::NORM_INF), 0.0);
    EXPECT_TRUE(photo->mask.empty()) << "nothing of it is transparent";
}

TEST_F(ReadPhotoTest, RefusesTinyImages) {
    for (const char* extension : {".png", ".jpg", ".tiff", ".bmp", ".ppm", ".webp"}) {
        const PhotoFile photo =
            folder_.write(std::string("dot") + extension,
                          encode(cv::Mat(1, 1, CV_8UC3, cv::Scalar(9, 9, 9)), extension));
        EXPECT_THAT(refusal(photo),
                    AllOf(HasSubstr("too small (1x1 pixels)"), HasSubstr("at least 64")));
    }
    EXPECT_THAT(refusal(folder_.write("strip.png", encode(textured_image(500, 63), ".png"))),
                HasSubstr("too small"));
    EXPECT_TRUE(
        read_photo(folder_.write("square.png", encode(textured_image(64, 64), ".png")), {}));
}

TEST_F(ReadPhotoTest, RefusesTruncatedFilesWithTheirLength) {
    for (const char* extension : {".jpg", ".png", ".tiff", ".webp", ".bmp", ".ppm", ".jp2"}) {
        Bytes bytes = encode(textured_image(200, 150), extension);
        bytes.resize(bytes.size() / 2);
        EXPECT_THAT(refusal(folder_.write(std::string("half") + extension, bytes)),
                    AllOf(HasSubstr("truncated: " + std::to_string(bytes.size()) + " bytes"),
                          HasSubstr("ends in the middle; copy the file again")));
    }
}

TEST_F(ReadPhotoTest, RefusesWhatIsNoImage) {
    EXPECT_THAT(refusal(folder_.write("empty.jpg", "")),
                HasSubstr("is empty (0 bytes); copy the file again"));
    EXPECT_THAT(refusal(folder_.write("text.jpg", "hello\nworld, how are you")),
                HasSubstr("is not an image: its first bytes are \"hello\\x0aworld,\""));
    EXPECT_THAT(refusal(folder_.write("short.jpg", "\xFF\xD8\xFF")),
                HasSubstr("truncated: 3 bytes"));
}

TEST_F(ReadPhotoTest, RefusesWhatCannotBeRead) {
    std::filesystem::create_directory(folder_.path() / "x.jpg");
    EXPECT_THAT(refusal({folder_.path() / "x.jpg", "x.jpg"}), HasSubstr("is a folder"));
    EXPECT_THAT(refusal({folder_.path() / "gone.jpg", "gone.jpg"}, {}, ErrorCode::kIo),
                HasSubstr("cannot be opened"));
    ASSERT_EQ(::mkfifo((folder_.path() / "pipe.jpg").c_str(), 0600), 0);
    EXPECT_THAT(refusal({folder_.path() / "pipe.jpg", "pipe.jpg"}),
                HasSubstr("pipe, socket or device"));
    // Opens, but every read fails, for root as well.
    EXPECT_THAT(refusal({"/proc/self/mem", "mem.jpg"}, {}, ErrorCode::kIo),
                HasSubstr("cannot be read (Input/output error)"));
}

TEST_F(ReadPhotoTest, RefusesHugeImagesByTheirHeader) {
    // A PNG header that promises 60,000 x 60,000 pixels: 10.8 GB if it were believed.
    Bytes bytes = encode(textured_image(100, 100), ".png");
    for (const std::size_t at : {16U, 20U}) {
        bytes[at + 2] = 0xEA;
        bytes[at + 3] = 0x60;
    }
    EXPECT_THAT(refusal(folder_.write("huge.png", bytes)),
                AllOf(HasSubstr("60000x60000"), HasSubstr("3600.0 megapixels"),
                      HasSubstr("200 megapixels")));
    ReadPhotoOptions strict;
    strict.max_megapixels = 0.01;
    EXPECT_THAT(refusal(folder_.write("a.jpg", encode(textured_image(101, 100), ".jpg")), strict),
                HasSubstr("is too large"));
    EXPECT_TRUE(
        read_photo(folder_.write("b.jpg", encode(textured_image(100, 100), ".jpg")), strict));
}

TEST_F(ReadPhotoTest, RefusesLongFiles) {
    ReadPhotoOptions strict;
    strict.max_file_mib = 1;
    EXPECT_THAT(
        refusal(folder_.write("long.bmp", encode(textured_image(700, 600), ".bmp")), strict),
        HasSubstr("is longer than 1 MiB"));
}

TEST_F(ReadPhotoTest, RefusesFloatingPointPixels) {
    const cv::Mat image(80, 80, CV_32FC3, cv::Scalar(0.5, 0.5, 0.5));
    EXPECT_THAT(refusal(folder_.write("float.tiff", encode(image, ".tiff"))),
                HasSubstr("8- or 16-bit"));
}

TEST_F(ReadPhotoTest, NamesOfFilesStayOnOneLine) {
    const auto result = read_photo({folder_.path() / "gone", "two\nlines.jpg"}, {});
    ASSERT_FALSE(result);
    EXPECT_THAT(result.error().message, StartsWith("two\\x0alines.jpg: "));
}

TEST_F(ReadPhotoTest, ReadsAJpegThatLacksOnlyItsEnd) {
    const Bytes whole = encode(textured_image(200, 150), ".jpg");
    const auto expected = read_photo(folder_.write("whole.jpg", whole), {});
    ASSERT_TRUE(expected);
    EXPECT_TRUE(expected->remarks.empty());
    for (const std::size_t missing : {1U, 2U}) {
        const Bytes cut(whole.begin(), whole.end() - static_cast<std::ptrdiff_t>(missing));
        const auto photo = read_photo(folder_.write("cut.jpg", cut), {});
        ASSERT_TRUE(photo) << photo.error().message;
        EXPECT_EQ(cv::norm(photo->colour, expected->colour, cv::NORM_INF), 0.0);
        EXPECT_EQ(photo->content_hash, XXH64(cut.data(), cut.size(), 0)) << "that of the file";
        ASSERT_EQ(photo->remarks.size(), 1U);
        EXPECT_THAT(photo->remarks[0], AllOf(StartsWith("cut.jpg: "), HasSubstr("at its end")));
    }
    // Anything more, and some of the picture may be missing.
    for (const std::size_t missing : {8U, 100U}) {
        const Bytes cut(whole.begin(), whole.end() - static_cast<std::ptrdiff_t>(missing));
        EXPECT_THAT(refusal(folder_.write("cut.jpg", cut)), HasSubstr("ends in the middle"));
    }
}

TEST_F(ReadPhotoTest, ReadsAProgressiveJpegThatLacksOnlyItsEnd) {
    Bytes whole;
    cv::imencode(".jpg", textured_image(200, 150), whole, {cv::IMWRITE_JPEG_PROGRESSIVE, 1});
    Bytes cut(whole.begin(), whole.end() - 2);
    EXPECT_TRUE(read_photo(folder_.write("cut.jpg", cut), {}));
    // Up to the beginning of the last scan: a whole picture, but coarser than it was.
    std::size_t last_scan = 0;
    for (std::size_t i = 0; i + 1 < whole.size(); ++i) {
        if (whole[i] == 0xFF && whole[i + 1] == 0xDA) last_scan = i;
    }
    ASSERT_GT(last_scan, 0U);
    cut.resize(last_scan);
    EXPECT_THAT(refusal(folder_.write("coarse.jpg", cut)), HasSubstr("ends in the middle"));
}

TEST_F(ReadPhotoTest, ReadsTheFirstPictureOfAnMpoFile) {
    Bytes both = encode(textured_image(200, 150, 1), ".jpg");
    const auto first = read_photo(folder_.write("first.jpg", both), {});
    const Bytes second = encode(textured_image(200, 150, 2), ".jpg");
    both.insert(both.end(), second.begin(), second.end());
    const auto photo = read_photo(folder_.write("both.MPO", both), {});
    ASSERT_TRUE(photo) << photo.error().message;
    EXPECT_TRUE(photo->remarks.empty());
    EXPECT_EQ(cv::norm(photo->colour, first->colour, cv::NORM_INF), 0.0);
}

TEST_F(ReadPhotoTest, APositionThatIsNoPlaceIsTold) {
    Exiv2::ExifData data;
    data["Exif.GPSInfo.GPSLatitudeRef"] = "N";
    data["Exif.GPSInfo.GPSLatitude"] = Exiv2::URational(97, 1);
    data["Exif.GPSInfo.GPSLongitudeRef"] = "E";
    data["Exif.GPSInfo.GPSLongitude"] = Exiv2::URational(10, 1);
    const Bytes plain = encode(textured_image(200, 150, 1), ".jpg");
    const auto photo =
        read_photo(folder_.write("north.jpg", psfm::testing::with_exif(plain, data)), {});
    ASSERT_TRUE(photo) << photo.error().message;
    ASSERT_EQ(photo->remarks.size(), 1U);
    EXPECT_THAT(photo->remarks[0], AllOf(StartsWith("north.jpg: "), HasSubstr("no place on")));
}

TEST_F(ReadPhotoTest, TransparencyIsAMask) {
    for (const char* extension : {".png", ".webp", ".tiff"}) {
        cv::Mat picture;
        cv::cvtColor(textured_image(80, 70), picture, cv::COLOR_BGR2BGRA);
        picture(cv::Rect(10, 20, 30, 25)).forEach<cv::Vec4b>([](cv::Vec4b& pixel, const int*) {
            pixel[3] = 0;
        });
        const auto photo =
            read_photo(folder_.write(std::string("a") + extension, encode(picture, extension)), {});
        ASSERT_TRUE(photo) << photo.error().message;
        ASSERT_EQ(photo->mask.size(), picture.size()) << extension;
        EXPECT_EQ(cv::countNonZero(photo->mask == 0), 30 * 25) << extension;
        EXPECT_EQ(photo->mask.at<std::uint8_t>(25, 15), 0) << extension;
    }
}

TEST_F(ReadPhotoTest, NamesNoOptionThatPsfmLacks) {
    ReadPhotoOptions strict;
    strict.max_megapixels = 0.001;
    EXPECT_THAT(
        refusal(folder_.write("a.png", encode(textured_image(80, 80), ".png")), strict),
        AllOf(HasSubstr("too large"), HasSubstr("reduce it"), Not(HasSubstr("max_megapixels"))));
}

}  // namespace
}  // namespace psfm
