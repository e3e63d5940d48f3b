// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/run_features.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exiv2/exiv2.hpp>
#include <opencv2/core.hpp>
#include <optional>
#include <random>
#include <string_view>
#include <thread>

#include "tests/stages/features/photo_fixture.h"

namespace psfm {
namespace {

using testing::Bytes;
using testing::encode;
using ::testing::HasSubstr;
using testing::TemporaryFolder;
using testing::textured_image;

Bytes photo_with_exif(std::uint64_t seed) {
    Exiv2::ExifData exif;
    exif["Exif.Image.Make"] = "Maker";
    exif["Exif.Image.Model"] = "Model";
    exif["Exif.Image.Orientation"] = std::uint16_t{6};
    exif["Exif.Photo.FocalLength"] = Exiv2::URational(46, 10);
    exif["Exif.Photo.FocalLengthIn35mmFilm"] = std::uint16_t{28};
    return testing::with_exif(encode(textured_image(240, 160, seed), ".jpg"), exif);
}

TEST(RunFeaturesTest, FillsTheMetadata) {
    const TemporaryFolder folder;
    const auto photo = run_features(folder.write("a.jpg", photo_with_exif(1)), {});
    ASSERT_TRUE(photo) << photo.error().message;
    const PhotoMetadata& metadata = photo->metadata;
    EXPECT_EQ(metadata.width, 240U);  // on its side, as stored
    EXPECT_EQ(metadata.height, 160U);
    EXPECT_EQ(metadata.orientation, 6);
    EXPECT_EQ(metadata.make, "Maker");
    EXPECT_EQ(metadata.model, "Model");
    EXPECT_EQ(metadata.focal_mm, 4.6);
    EXPECT_NEAR(metadata.focal_px.value(), 28.0 / 36.0 * 240.0, 1e-9);
    EXPECT_NE(metadata.content_hash, 0U);
    EXPECT_GT(photo->keypoints.size(), 100U);
    EXPECT_EQ(photo->keypoints.size(), photo->descriptors.rows());
}

TEST(RunFeaturesTest, EqualBytesGiveEqualResultsOnManyThreads) {
    const TemporaryFolder folder;
    const PhotoFile file = folder.write("a.jpg", photo_with_exif(2));
    const auto expected = run_features(file, {});
    ASSERT_TRUE(expected);
    std::array<std::optional<Result<ExtractedPhoto>>, 4> results;
    std::vector<std::jthread> threads;
    for (auto& result : results) threads.emplace_back([&] { result = run_features(file, {}); });
    threads.clear();
    for (const auto& result : results) {
        ASSERT_TRUE(result && result->ok());
        EXPECT_EQ(result->value().metadata, expected->metadata);
        EXPECT_EQ(result->value().keypoints, expected->keypoints);
        EXPECT_EQ(result->value().descriptors, expected->descriptors);
    }
}

TEST(RunFeaturesTest, WhiteWallsAreASuccess) {
    const TemporaryFolder folder;
    const auto photo = run_features(
        folder.write("wall.png", encode(cv::Mat(100, 100, CV_8UC3, cv::Scalar::all(255)), ".png")),
        {});
    ASSERT_TRUE(photo) << photo.error().message;
    EXPECT_TRUE(photo->keypoints.empty());
    EXPECT_FALSE(photo->metadata.focal_px);
}

TEST(RunFeaturesTest, BrokenExifCountsAsNone) {
    Bytes bytes = photo_with_exif(3);
    constexpr std::string_view kHeader = "Exif";
    const auto exif = std::search(bytes.begin(), bytes.end(), kHeader.begin(), kHeader.end());
    ASSERT_NE(exif, bytes.end());
    std::fill(exif + 10, exif + 60,
              std::uint8_t{0xFF});  // the directory, with its counts and offsets
    const TemporaryFolder folder;
    const auto photo = run_features(folder.write("a.jpg", bytes), {});
    ASSERT_TRUE(photo) << photo.error().message;
    EXPECT_TRUE(photo->metadata.make.empty());
    EXPECT_FALSE(photo->metadata.focal_px);
    EXPECT_EQ(photo->metadata.orientation, 1);
    EXPECT_GT(photo->keypoints.size(), 100U);
}

TEST(RunFeaturesTest, BadInputIsAnErrorWithTheName) {
    const TemporaryFolder folder;
    const auto result = run_features(folder.write("text.jpg", "no photograph"), {});
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, ErrorCode::kUnreadable);
    EXPECT_THAT(result.error().message, HasSubstr("text.jpg: is not an image"));
}

TEST(RunFeaturesTest, DamagedFilesNeverEscapeAsExceptions) {
    const TemporaryFolder folder;
    std::mt19937 random(5);
    FeatureOptions options;
    options.sift.max_image_size = 64;
    for (const std::string extension : {".jpg", ".png", ".tiff", ".webp", ".bmp", ".ppm", ".jp2"}) {
        const Bytes bytes = encode(textured_image(97, 71), extension);
        for (int i = 0; i < 30; ++i) {
            Bytes damaged = bytes;
            for (int k = 0; k < 5; ++k) {
                damaged[8 + random() % (k < 2 ? 100 : damaged.size() - 8)] =
                    static_cast<std::uint8_t>(random());
            }
            const auto result = run_features(folder.write("damaged" + extension, damaged), options);
            if (result) continue;
            EXPECT_EQ(result.error().code, ErrorCode::kUnreadable) << result.error().message;
            EXPECT_THAT(result.error().message, HasSubstr("damaged" + extension + ": "));
        }
    }
}

TEST(RunFeaturesTest, ChecksItsOptions) {
    FeatureOptions options;
    options.sift.max_features = 0;
    const auto result = run_features({"a.jpg", "a.jpg"}, options);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, ErrorCode::kInvalidArgument);
    EXPECT_THAT(result.error().message, HasSubstr("max_features"));
    EXPECT_TRUE(validate(FeatureOptions{}));
    options = {};
    options.read.max_megapixels = std::nan("");
    EXPECT_FALSE(validate(options));
}

}  // namespace
}  // namespace psfm
