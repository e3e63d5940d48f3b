// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/sift/extract_sift.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <set>
#include <tuple>

#include "tests/stages/features/photo_fixture.h"

namespace psfm {
namespace {

using testing::textured_image;

cv::Mat to_grey(const cv::Mat& colour) {
    cv::Mat grey;
    cv::cvtColor(colour, grey, cv::COLOR_BGR2GRAY);
    return grey;
}

SiftFeatures extract(const cv::Mat& colour, const SiftOptions& options = {}) {
    auto features = extract_sift(to_grey(colour), colour, options);
    EXPECT_TRUE(features) << features.error().message;
    return std::move(features).value();
}

TEST(ExtractSiftTest, OneDescriptorAKeypointInsideTheImage) {
    const cv::Mat image = textured_image(320, 240);
    const SiftFeatures features = extract(image);
    ASSERT_GT(features.keypoints.size(), 200U);
    ASSERT_EQ(features.descriptors.rows(), features.keypoints.size());
    for (const Keypoint& keypoint : features.keypoints) {
        EXPECT_TRUE(keypoint.x > 0.F && keypoint.x < 320.F && keypoint.y > 0.F &&
                    keypoint.y < 240.F);
        EXPECT_TRUE(keypoint.angle >= 0.F && keypoint.angle <= 2.F * std::numbers::pi_v<float>);
        EXPECT_GT(keypoint.scale, 0.F);
        const auto& bgr =
            image.at<cv::Vec3b>(static_cast<int>(keypoint.y), static_cast<int>(keypoint.x));
        EXPECT_EQ(std::tuple(keypoint.blue, keypoint.green, keypoint.red),
                  std::tuple(bgr[0], bgr[1], bgr[2]));
    }
}

TEST(ExtractSiftTest, DescriptorsHaveTheNormOfRootSift) {
    const SiftFeatures features = extract(textured_image(320, 240));
    for (std::size_t i = 0; i < features.descriptors.rows(); ++i) {
        double squares = 0.0;
        for (std::size_t k = 0; k < Descriptors::kSize; ++k) {
            squares += std::pow(static_cast<double>(features.descriptors.row(i)[k]), 2);
        }
        EXPECT_NEAR(std::sqrt(squares), 512.0, 6.0) << i;
    }
}

TEST(ExtractSiftTest, StrictlyOrderedLargestFirst) {
    const SiftFeatures features = extract(textured_image(320, 240));
    const auto key = [](const Keypoint& k) { return std::tuple(-k.scale, k.y, k.x, k.angle); };
    for (std::size_t i = 1; i < features.keypoints.size(); ++i) {
        EXPECT_LT(key(features.keypoints[i - 1]), key(features.keypoints[i])) << i;
    }
}

TEST(ExtractSiftTest, RepeatsItself) {
    const cv::Mat image = textured_image(320, 240);
    const SiftFeatures first = extract(image);
    const SiftFeatures second = extract(image);
    EXPECT_EQ(first.keypoints, second.keypoints);
    EXPECT_EQ(first.descriptors, second.descriptors);
}

TEST(ExtractSiftTest, TheSameOnAnyNumberOfThreads) {
    const cv::Mat image = textured_image(700, 501);  // several bands, and tasks of places
    const auto on_threads = [&](int threads) {
        tbb::task_arena arena(threads);
        return arena.execute([&] { return extract(image); });
    };
    const SiftFeatures alone = on_threads(1);
    EXPECT_GT(alone.keypoints.size(), 1000U);
    for (int round = 0; round < 3; ++round) {
        const SiftFeatures together = on_threads(4);
        EXPECT_EQ(alone.keypoints, together.keypoints);
        EXPECT_EQ(alone.descriptors, together.descriptors);
    }
}

std::size_t places_of(const SiftFeatures& features) {
    std::set<std::tuple<float, float, float>> places;
    for (const Keypoint& keypoint : features.keypoints)
        places.emplace(keypoint.scale, keypoint.y, keypoint.x);
    return places.size();
}

TEST(ExtractSiftTest, CutsToTheLargestPlacesAndKeepsTheirOrientations) {
    const cv::Mat image = textured_image(320, 240);
    const SiftFeatures all = extract(image);
    SiftOptions options;
    options.max_features = 50;
    const SiftFeatures largest = extract(image, options);
    EXPECT_EQ(places_of(largest), 50U);
    ASSERT_GT(largest.keypoints.size(), 50U);  // some have two orientations
    EXPECT_TRUE(
        std::equal(largest.keypoints.begin(), largest.keypoints.end(), all.keypoints.begin()));
    EXPECT_TRUE(std::equal(largest.descriptors.values.begin(), largest.descriptors.values.end(),
                           all.descriptors.values.begin()));
    options.max_orientations = 1;
    const SiftFeatures single = extract(image, options);
    EXPECT_EQ(single.keypoints.size(), 50U);
    EXPECT_EQ(places_of(single), 50U);
}

TEST(ExtractSiftTest, NothingLiesUnderTheMaskAndTheChoiceIsMadeOfTheRest) {
    const cv::Mat image = textured_image(320, 240);
    cv::Mat mask(240, 320, CV_8UC1, cv::Scalar(255));
    mask(cv::Rect(0, 0, 160, 240)) = 0;
    SiftOptions options;
    options.max_features = 50;
    const SiftFeatures all = extract(image);
    const auto features = extract_sift(to_grey(image), image, options, mask);
    ASSERT_TRUE(features) << features.error().message;
    EXPECT_EQ(places_of(*features), 50U);
    for (const Keypoint& keypoint : features->keypoints) {
        EXPECT_GE(keypoint.x, 160.F);
        EXPECT_NE(std::find(all.keypoints.begin(), all.keypoints.end(), keypoint),
                  all.keypoints.end());
    }
    // Of photographs that are reduced, it is the full one's mask.
    options.max_image_size = 200;
    const auto reduced = extract_sift(to_grey(image), image, options, mask);
    ASSERT_TRUE(reduced);
    EXPECT_FALSE(reduced->keypoints.empty());
    for (const Keypoint& keypoint : reduced->keypoints) EXPECT_GE(keypoint.x, 160.F);
    mask = 0;
    EXPECT_TRUE(extract_sift(to_grey(image), image, options, mask)->keypoints.empty());
}

TEST(ExtractSiftTest, AnglesTurnWithTheImage) {
    const cv::Mat image = textured_image(200, 200);
    cv::Mat turned;
    cv::rotate(image, turned, cv::ROTATE_90_CLOCKWISE);
    const SiftFeatures before = extract(image);
    const SiftFeatures after = extract(turned);
    std::size_t found = 0;
    for (const Keypoint& a : before.keypoints) {
        for (const Keypoint& b : after.keypoints) {
            // (x, y) goes to (height - y, x).
            if (std::hypot(b.x - (200.F - a.y), b.y - a.x) > 0.3F ||
                std::abs(b.scale / a.scale - 1.F) > 0.05F)
                continue;
            const double turn = b.angle - a.angle - std::numbers::pi / 2.0;
            if (std::abs(std::remainder(turn, 2.0 * std::numbers::pi)) < 0.1) {
                ++found;
                break;
            }
        }
    }
    EXPECT_GT(found, before.keypoints.size() * 8 / 10);
}

/// The contrast threshold means what COLMAP's peak_threshold does: an extremum of the difference of
/// Gaussians counts when it is above threshold / octave_layers, grey values from 0 to 1.
TEST(ExtractSiftTest, ContrastThresholdIsPerOctave) {
    const auto is_found = [](double amplitude, double threshold) {
        cv::Mat values(129, 129, CV_64F);
        const double sigma = 4.0;
        for (int y = 0; y < 129; ++y) {
            for (int x = 0; x < 129; ++x) {
                const double squared = (x - 64) * (x - 64) + (y - 64) * (y - 64);
                values.at<double>(y, x) =
                    60.0 + 255.0 * amplitude * std::exp(-0.5 * squared / (sigma * sigma));
            }
        }
        cv::Mat grey;
        values.convertTo(grey, CV_8U);
        cv::Mat colour;
        cv::cvtColor(grey, colour, cv::COLOR_GRAY2BGR);
        SiftOptions options;
        options.contrast_threshold = threshold;
        return !extract_sift(grey, colour, options)->keypoints.empty();
    };
    // With sigma matched, blurred by s and k s: A (sigma^2 / (sigma^2 + s^2) - sigma^2 / (sigma^2 +
    // k^2 s^2)), largest near s = sigma / sqrt(k), there A (k - 1) / (k + 1) = 0.115 A. Found when
    // above threshold / 3.
    for (const double threshold : {0.02, 0.08}) {
        const double limit = threshold / 3.0 / 0.115;
        EXPECT_FALSE(is_found(0.8 * limit, threshold)) << threshold;
        EXPECT_TRUE(is_found(1.3 * limit, threshold)) << threshold;
    }
}

TEST(ExtractSiftTest, FlatImagesHaveNoFeatures) {
    const SiftFeatures features = extract(cv::Mat(100, 100, CV_8UC3, cv::Scalar(80, 80, 80)));
    EXPECT_TRUE(features.keypoints.empty());
    EXPECT_EQ(features.descriptors.rows(), 0U);
}

TEST(ExtractSiftTest, RefusesWrongInputs) {
    const cv::Mat image = textured_image(100, 100);
    const cv::Mat grey = to_grey(image);
    const auto code = [](const Result<SiftFeatures>& result) {
        return result ? ErrorCode::kIo : result.error().code;
    };
    EXPECT_EQ(code(extract_sift(image, image, {})), ErrorCode::kInvalidArgument);
    EXPECT_EQ(code(extract_sift(grey, grey, {})), ErrorCode::kInvalidArgument);
    EXPECT_EQ(code(extract_sift({}, {}, {})), ErrorCode::kInvalidArgument);
    EXPECT_EQ(code(extract_sift(grey, textured_image(101, 100), {})), ErrorCode::kInvalidArgument);
    EXPECT_EQ(code(extract_sift(grey, image, {}, textured_image(100, 100))),
              ErrorCode::kInvalidArgument);
    EXPECT_EQ(code(extract_sift(grey, image, {}, cv::Mat(99, 100, CV_8UC1, cv::Scalar(255)))),
              ErrorCode::kInvalidArgument);
    SiftOptions options;
    options.contrast_threshold = std::nan("");
    EXPECT_EQ(code(extract_sift(grey, image, options)), ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace psfm
