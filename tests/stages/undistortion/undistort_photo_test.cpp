// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/undistortion/undistort_photo.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <xxhash.h>

#include <exiv2/exiv2.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "tests/stages/features/heif_fixture.h"
#include "tests/stages/features/photo_fixture.h"

namespace psfm {
namespace {

using testing::Bytes;
using testing::encode;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using testing::TemporaryFolder;
using testing::textured_image;

class UndistortPhotoTest : public ::testing::Test {
  protected:
    static std::uint64_t hash(const Bytes& bytes) { return XXH64(bytes.data(), bytes.size(), 0); }

    static UndistortedView view_of(int width, int height, double k, std::uint8_t turns = 0) {
        Camera camera = make_camera(static_cast<std::uint32_t>(width),
                                    static_cast<std::uint32_t>(height), 200.0, FocalSource::kExif);
        camera.params[3] = k;
        return *make_undistorted_view(camera, turns, {});
    }

    static Bytes oriented(const Bytes& jpeg, int orientation) {
        Exiv2::ExifData exif;
        exif["Exif.Image.Orientation"] = static_cast<std::uint16_t>(orientation);
        return testing::with_exif(jpeg, exif);
    }

    TemporaryFolder folder_;
};

TEST_F(UndistortPhotoTest, ExtensionsFollowThePhotograph) {
    EXPECT_EQ(picture_extension("a/b.PNG", PictureFormat::kAuto), ".png");
    EXPECT_EQ(picture_extension("a/b.heic", PictureFormat::kAuto), ".jpg");
    EXPECT_EQ(picture_extension("b.tif", PictureFormat::kAuto), ".jpg");
    EXPECT_EQ(picture_extension("b.png", PictureFormat::kJpeg), ".jpg");
    EXPECT_EQ(picture_extension("b.jpg", PictureFormat::kPng), ".png");
}

TEST_F(UndistortPhotoTest, WhatNeedsNothingIsCopied) {
    const Bytes bytes = encode(textured_image(120, 80), ".jpg");
    const auto photo = folder_.write("a.jpg", bytes);
    const auto files = undistort_photo(photo, hash(bytes), 1, view_of(120, 80, 0.0), {});
    ASSERT_TRUE(files) << files.error().message;
    EXPECT_EQ(files->bytes.front(), bytes);
}

TEST_F(UndistortPhotoTest, WhatCannotBeReadIsNotGone) {
    const auto gone =
        undistort_photo({folder_.path() / "a.jpg", "a.jpg"}, 1, 1, view_of(120, 80, 0.0), {});
    EXPECT_THAT(gone.error().message, HasSubstr("is not in its folder any more"));
    std::filesystem::create_symlink("loop", folder_.path() / "loop");
    // As without permission, for root too.
    const auto denied = undistort_photo({folder_.path() / "loop" / "a.jpg", "a.jpg"}, 1, 1,
                                        view_of(120, 80, 0.0), {});
    EXPECT_THAT(denied.error().message, StartsWith("a.jpg: cannot be opened"));
}

// cv::imread, which OpenSplat uses, turns what says how to turn it.
TEST_F(UndistortPhotoTest, AllEightOrientationsComeUprightAndSayNothingOfIt) {
    cv::Mat upright = textured_image(80, 80);
    upright.rowRange(0, 20).setTo(cv::Scalar(255, 255, 255));  // the sky
    const std::array<int, 9> rotations{-1, -1, -1, cv::ROTATE_180, cv::ROTATE_180,
                                       // as stored: turned the other way than to show it
                                       cv::ROTATE_90_COUNTERCLOCKWISE,
                                       cv::ROTATE_90_COUNTERCLOCKWISE, cv::ROTATE_90_CLOCKWISE,
                                       cv::ROTATE_90_CLOCKWISE};
    for (int orientation = 1; orientation <= 8; ++orientation) {
        cv::Mat stored = upright.clone();
        if (const int rotation = rotations.at(static_cast<std::size_t>(orientation)); rotation >= 0)
            cv::rotate(upright, stored, rotation);
        const Bytes bytes = oriented(encode(stored, ".jpg"), orientation);
        const auto photo = folder_.write(std::to_string(orientation) + ".jpg", bytes);
        const auto turns = upright_quarter_turns(static_cast<std::uint8_t>(orientation));
        const auto files =
            undistort_photo(photo, hash(bytes), static_cast<std::uint8_t>(orientation),
                            view_of(80, 80, 0.0, turns), {});
        ASSERT_TRUE(files) << files.error().message;
        const cv::Mat picture = cv::imdecode(files->bytes.front(), cv::IMREAD_COLOR);
        const cv::Mat stored_picture =
            cv::imdecode(files->bytes.front(), cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
        EXPECT_EQ(cv::norm(picture, stored_picture, cv::NORM_INF), 0.0) << orientation;
        EXPECT_GT(cv::mean(picture.rowRange(2, 18))[0], 240) << orientation;
        EXPECT_LT(cv::mean(picture.rowRange(30, 80))[0], 200) << orientation;
    }
}

TEST_F(UndistortPhotoTest, AHeifPictureBecomesAJpeg) {
    const Bytes bytes = testing::encode_heif(textured_image(128, 96), {});
    if (bytes.empty()) GTEST_SKIP() << "this libheif cannot encode";
    const auto photo = folder_.write("a.heic", bytes);
    const auto files = undistort_photo(photo, hash(bytes), 1, view_of(128, 96, -0.05), {});
    ASSERT_TRUE(files) << files.error().message;
    const Bytes& picture = files->bytes.front();
    ASSERT_GT(picture.size(), 3U);
    EXPECT_EQ(picture[0], 0xff);
    EXPECT_EQ(picture[1], 0xd8);
}

TEST_F(UndistortPhotoTest, ReducedCopiesAreExactParts) {
    const Bytes bytes = encode(textured_image(160, 96), ".png");
    const auto photo = folder_.write("a.png", bytes);
    UndistortedViewOptions by_eight;
    by_eight.multiple = 8;
    const Camera camera = make_camera(160, 96, 200.0, FocalSource::kExif);
    PictureOptions options;
    options.reductions = {2, 4, 8};
    const auto files = undistort_photo(photo, hash(bytes), 1,
                                       *make_undistorted_view(camera, 0, by_eight), options);
    ASSERT_TRUE(files) << files.error().message;
    ASSERT_EQ(files->bytes.size(), 4U);
    const int factors[] = {1, 2, 4, 8};
    for (std::size_t k = 0; k < 4; ++k) {
        const cv::Mat picture = cv::imdecode(files->bytes[k], cv::IMREAD_COLOR);
        EXPECT_EQ(picture.cols, 160 / factors[k]);
        EXPECT_EQ(picture.rows, 96 / factors[k]);
    }
}

TEST_F(UndistortPhotoTest, WhatIsNotThePhotographIsRefusedByName) {
    const Bytes bytes = encode(textured_image(120, 80), ".jpg");
    const auto photo = folder_.write("sub/a.jpg", bytes);
    const auto other = undistort_photo(photo, hash(bytes) + 1, 1, view_of(120, 80, 0.1), {});
    ASSERT_FALSE(other);
    EXPECT_THAT(other.error().message, StartsWith("sub/a.jpg: "));
    EXPECT_THAT(other.error().message, HasSubstr("put the old one back"));
    const auto gone =
        undistort_photo({folder_.path() / "b.jpg", "b.jpg"}, 0, 1, view_of(120, 80, 0.1), {});
    ASSERT_FALSE(gone);
    EXPECT_THAT(gone.error().message, HasSubstr("--images"));
    const auto size = undistort_photo(photo, hash(bytes), 1, view_of(80, 120, 0.1), {});
    ASSERT_FALSE(size);
    EXPECT_THAT(size.error().message, HasSubstr("another size"));
}

}  // namespace
}  // namespace psfm
