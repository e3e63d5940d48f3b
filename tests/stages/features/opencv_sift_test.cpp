// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "stages/features/sift/extract_sift.h"
#include "stages/features/sift/root_sift.h"
#include "tests/stages/features/photo_fixture.h"

// An independent implementation finds the same features in the whole image.
namespace psfm {
namespace {

struct Agreement {
    std::size_t features = 0;   ///< of the first
    std::size_t placed = 0;     ///< found at the same place, in the same scale
    std::size_t turned = 0;     ///< and with the same orientation
    std::size_t described = 0;  ///< and with nearly the same descriptor
};

Agreement compare(const SiftFeatures& a, const SiftFeatures& b) {
    Agreement result;
    result.features = a.keypoints.size();
    for (std::size_t i = 0; i < a.keypoints.size(); ++i) {
        bool placed = false;
        bool turned = false;
        bool described = false;
        for (std::size_t j = 0; j < b.keypoints.size(); ++j) {
            const Keypoint& p = a.keypoints[i];
            const Keypoint& q = b.keypoints[j];
            if (std::hypot(p.x - q.x, p.y - q.y) > 0.3F * p.scale ||
                std::abs(std::log2(p.scale / q.scale)) > 0.15F)
                continue;
            placed = true;
            const float turn = std::remainder(p.angle - q.angle, 2.F * std::numbers::pi_v<float>);
            if (std::abs(turn) > 0.15F) continue;
            turned = true;
            double squares = 0.0;
            for (std::size_t k = 0; k < Descriptors::kSize; ++k) {
                squares += std::pow(static_cast<double>(a.descriptors.row(i)[k]) -
                                        static_cast<double>(b.descriptors.row(j)[k]),
                                    2);
            }
            described |= std::sqrt(squares) < 0.25 * 512.0;
        }
        result.placed += placed ? 1 : 0;
        result.turned += turned ? 1 : 0;
        result.described += described ? 1 : 0;
    }
    return result;
}

SiftFeatures by_opencv(const cv::Mat& grey) {
    const auto sift = cv::SIFT::create(0, 3, 0.02, 10.0, 1.6, CV_32F);
    std::vector<cv::KeyPoint> found;
    cv::Mat values;
    sift->detectAndCompute(grey, cv::noArray(), found, values);
    SiftFeatures result;
    result.descriptors.values.resize(found.size() * Descriptors::kSize);
    for (std::size_t i = 0; i < found.size(); ++i) {
        Keypoint keypoint;
        // A quarter less than half a pixel: it halves the doubled image without its half pixel.
        keypoint.x = found[i].pt.x + 0.25F;
        keypoint.y = found[i].pt.y + 0.25F;
        keypoint.scale = 0.5F * found[i].size;
        keypoint.angle = found[i].angle * std::numbers::pi_v<float> / 180.F;
        result.keypoints.push_back(keypoint);
        write_root_sift(
            {values.ptr<float>(static_cast<int>(i)), Descriptors::kSize},
            {result.descriptors.values.data() + i * Descriptors::kSize, Descriptors::kSize});
    }
    return result;
}

TEST(OpenCvSiftTest, FindsTheSameFeatures) {
    const cv::Mat colour = testing::textured_image(400, 300);
    cv::Mat grey;
    cv::cvtColor(colour, grey, cv::COLOR_BGR2GRAY);
    SiftOptions options;
    options.max_orientations = 36;
    options.strip_mib = 2;  // in strips
    const auto ours = extract_sift(grey, colour, options);
    ASSERT_TRUE(ours);
    const SiftFeatures theirs = by_opencv(grey);
    const auto share = [](std::size_t part, std::size_t all) {
        return static_cast<double>(part) / static_cast<double>(all);
    };
    for (const Agreement& both : {compare(*ours, theirs), compare(theirs, *ours)}) {
        EXPECT_GT(both.features, 1000U);
        EXPECT_GT(share(both.placed, both.features), 0.99);
        EXPECT_GT(share(both.turned, both.features), 0.985);
        EXPECT_GT(share(both.described, both.features), 0.985);
    }
}

}  // namespace
}  // namespace psfm
