// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/photographs/picture_signature.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "stages/features/photographs/photo_listing.h"
#include "stages/features/photographs/reduced_copy.h"
#include "stages/features/photographs/small_copies.h"
#include "tests/stages/features/photo_fixture.h"

namespace psfm {
namespace {

using ::testing::ElementsAre;
using testing::encode;
using testing::TemporaryFolder;

/// Coarse structure, as photographs have.
cv::Mat picture(int width, int height, std::uint64_t seed) {
    cv::Mat small(12, 16, CV_8UC3);
    cv::RNG random(seed);
    random.fill(small, cv::RNG::UNIFORM, 0, 256);
    cv::Mat large;
    cv::resize(small, large, {width, height}, 0, 0, cv::INTER_CUBIC);
    return large;
}

struct Seen {
    std::vector<std::uint8_t> signature;
    Glance glance;
};
Seen look_at(const cv::Mat& colour, std::uint8_t orientation = 1) {
    cv::Mat grey;
    cv::cvtColor(colour, grey, cv::COLOR_BGR2GRAY);
    Seen seen{picture_signature(grey, orientation), {}};
    seen.glance = {static_cast<std::uint32_t>(grey.cols), static_cast<std::uint32_t>(grey.rows),
                   orientation, seen.signature};
    return seen;
}

cv::Mat reduced(const cv::Mat& large, int width, int height) {
    cv::Mat small;
    cv::resize(large, small, {width, height}, 0, 0, cv::INTER_LINEAR);
    return cv::imdecode(encode(small, ".jpg"), cv::IMREAD_COLOR);
}

TEST(PictureSignatureTest, TellsSmallCopies) {
    const cv::Mat large = picture(640, 480, 1);
    const Seen original = look_at(large);
    EXPECT_TRUE(is_reduced_copy(look_at(reduced(large, 160, 120)).glance, original.glance, {}));
    EXPECT_TRUE(is_reduced_copy(look_at(reduced(large, 500, 375)).glance, original.glance, {}));
    EXPECT_FALSE(is_reduced_copy(original.glance, original.glance, {}));
    EXPECT_FALSE(is_reduced_copy(original.glance, look_at(reduced(large, 160, 120)).glance, {}));
    EXPECT_FALSE(is_reduced_copy(look_at(reduced(large, 160, 160)).glance, original.glance, {}));
    EXPECT_FALSE(is_reduced_copy(look_at(picture(160, 120, 2)).glance, original.glance, {}));
    EXPECT_FALSE(is_reduced_copy({160, 120, 1, {}}, original.glance, {}))
        << "nothing is known of it";
}

TEST(PictureSignatureTest, AnotherViewOfTheSameIsNone) {
    const cv::Mat large = picture(640, 480, 1);
    const cv::Mat shifted = large(cv::Rect(20, 0, 600, 450));
    EXPECT_FALSE(
        is_reduced_copy(look_at(reduced(shifted, 160, 120)).glance, look_at(large).glance, {}));
}

TEST(PictureSignatureTest, ASkyAboveAPlainIsAlikeInManyPhotographs) {
    const auto plain = [](std::uint64_t seed) {
        cv::Mat large(480, 640, CV_8UC3, cv::Scalar(220, 220, 220));
        cv::Mat ground = picture(640, 280, seed);
        ground.convertTo(large.rowRange(200, 480), CV_8UC3, 0.1, 60.0);
        return large;
    };
    EXPECT_TRUE(
        is_reduced_copy(look_at(reduced(plain(1), 160, 120)).glance, look_at(plain(1)).glance, {}));
    EXPECT_FALSE(
        is_reduced_copy(look_at(reduced(plain(2), 160, 120)).glance, look_at(plain(1)).glance, {}));
}

TEST(PictureSignatureTest, TurnedOnesAreTheSame) {
    // Stored as the sensor had it, and a preview that was turned upright.
    const cv::Mat stored = picture(640, 480, 3);
    cv::Mat upright;
    cv::rotate(stored, upright, cv::ROTATE_90_CLOCKWISE);
    EXPECT_TRUE(
        is_reduced_copy(look_at(reduced(upright, 120, 160)).glance, look_at(stored, 6).glance, {}));
    EXPECT_FALSE(
        is_reduced_copy(look_at(reduced(upright, 120, 160)).glance, look_at(stored, 8).glance, {}));
    EXPECT_FALSE(
        is_reduced_copy(look_at(reduced(upright, 120, 160)).glance, look_at(stored, 1).glance, {}));
}

TEST(PictureSignatureTest, OfAWallNothingCanBeSaid) {
    const cv::Mat wall(480, 640, CV_8UC3, cv::Scalar(200, 210, 205));
    EXPECT_FALSE(
        is_reduced_copy(look_at(reduced(wall, 160, 120)).glance, look_at(wall).glance, {}));
}

TEST(SmallCopiesTest, ComeLast) {
    const TemporaryFolder folder;
    const cv::Mat a = picture(640, 480, 1);
    const cv::Mat b = picture(640, 480, 2);
    folder.write("IMG_1.jpg", encode(a, ".jpg"));
    folder.write("IMG_1-160x120.jpg", encode(reduced(a, 160, 120), ".jpg"));
    folder.write("IMG_10.jpg", encode(reduced(a, 320, 240), ".jpg"));  // its name says nothing
    folder.write("Small/img_1.png", encode(reduced(a, 160, 120), ".png"));
    folder.write("Small/img_2.png", encode(reduced(a, 160, 120), ".png"));  // is no copy of b
    folder.write("img_2.jpg", encode(b, ".jpg"));
    auto photos = list_photos(folder.path())->photos;
    put_small_copies_last(photos, {});
    std::vector<std::string> names;
    for (const PhotoFile& photo : photos) names.push_back(photo.name);
    EXPECT_THAT(names, ElementsAre("IMG_1.jpg", "IMG_10.jpg", "Small/img_2.png", "img_2.jpg",
                                   "IMG_1-160x120.jpg", "Small/img_1.png"));
}

}  // namespace
}  // namespace psfm
