// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "stages/features/sift/extract_sift.h"

// Pins the pixel origin of the features: OpenCV's own coordinates are 0.25 px (of the detection
// image) off, which would be noticed nowhere else but in the accuracy of every pose.
namespace psfm {
namespace {

const double kScaleRatio = std::pow(2.0, -1.0 / 6.0);

struct Blob {
    Eigen::Vector2d centre;  ///< [px, origin at the top-left corner of the top-left pixel]
    double sigma;            ///< [px]
};

/// Gaussian blobs on grey, a grid of sub-pixel offsets; bright and dark by turns.
std::vector<Blob> make_blobs(double spacing, double sigma) {
    std::vector<Blob> blobs;
    for (int row = 0; row < 8; ++row) {
        for (int column = 0; column < 8; ++column) {
            blobs.push_back(
                {{(column + 1) * spacing + column / 8.0, (row + 1) * spacing + row / 8.0}, sigma});
        }
    }
    return blobs;
}

cv::Mat render(const std::vector<Blob>& blobs, double spacing) {
    const int size = static_cast<int>(9 * spacing) + 1;
    cv::Mat sum(size, size, CV_64F, cv::Scalar(128.0));
    for (std::size_t i = 0; i < blobs.size(); ++i) {
        const double amplitude = i % 2 == 0 ? 100.0 : -100.0;
        const double reach = 6.0 * blobs[i].sigma;  // beyond, less than 1e-5 of a grey value
        const auto clamped = [&](double value) {
            return std::clamp(static_cast<int>(value), 0, size);
        };
        for (int y = clamped(blobs[i].centre.y() - reach); y < clamped(blobs[i].centre.y() + reach);
             ++y) {
            for (int x = clamped(blobs[i].centre.x() - reach);
                 x < clamped(blobs[i].centre.x() + reach); ++x) {
                const double squared =
                    (Eigen::Vector2d(x + 0.5, y + 0.5) - blobs[i].centre).squaredNorm();
                sum.at<double>(y, x) +=
                    amplitude * std::exp(-0.5 * squared / (blobs[i].sigma * blobs[i].sigma));
            }
        }
    }
    cv::Mat grey;
    sum.convertTo(grey, CV_8U);
    return grey;
}

struct Deviation {
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();  ///< found minus true [px]
    double worst = 0.0;                              ///< [px]
    double scale_ratio = 0.0;                        ///< found over true, mean
    std::size_t found = 0;
};

Deviation measure(const std::vector<Blob>& blobs, const Keypoints& keypoints) {
    Deviation result;
    for (const Blob& blob : blobs) {
        const Keypoint* best = nullptr;
        for (const Keypoint& keypoint : keypoints) {
            const double distance = (keypoint.position() - blob.centre).norm();
            if (distance > blob.sigma) continue;
            if (best == nullptr || distance < (best->position() - blob.centre).norm())
                best = &keypoint;
        }
        if (best == nullptr) continue;
        ++result.found;
        const Eigen::Vector2d error = best->position() - blob.centre;
        result.mean += error;
        result.worst = std::max(result.worst, error.norm());
        result.scale_ratio += best->scale / blob.sigma;
    }
    if (result.found > 0) {
        result.mean /= static_cast<double>(result.found);
        result.scale_ratio /= static_cast<double>(result.found);
    }
    return result;
}

class BlobPositionTest : public ::testing::TestWithParam<double> {};

TEST_P(BlobPositionTest, KeypointsLieOnTheCentres) {
    const double sigma = GetParam();
    const double spacing = std::max(24.0, 8.0 * sigma);
    const std::vector<Blob> blobs = make_blobs(spacing, sigma);
    const cv::Mat grey = render(blobs, spacing);
    cv::Mat colour;
    cv::cvtColor(grey, colour, cv::COLOR_GRAY2BGR);
    const auto features = extract_sift(grey, colour, {});
    ASSERT_TRUE(features) << features.error().message;
    const Deviation deviation = measure(blobs, features->keypoints);
    EXPECT_GE(deviation.found, 60U);
    EXPECT_LT(deviation.mean.cwiseAbs().maxCoeff(), 0.03) << deviation.mean.transpose();
    EXPECT_LT(deviation.worst, 0.05 * std::max(2.0, sigma));
    // The scale is that of the less blurred of the two layers, 2^(1/6) below the blob's own sigma.
    EXPECT_NEAR(deviation.scale_ratio, kScaleRatio, 0.05);
    RecordProperty("scale_ratio", std::to_string(deviation.scale_ratio));
}

INSTANTIATE_TEST_SUITE_P(Sigmas, BlobPositionTest, ::testing::Values(1.5, 2.0, 3.0, 4.5, 6.0, 9.0),
                         [](const auto& param) {
                             return "Sigma" + std::to_string(static_cast<int>(param.param * 10));
                         });

TEST(BlobPositionTest, ReducedImagesGiveCoordinatesOfTheFullOne) {
    const double sigma = 6.0;
    const std::vector<Blob> blobs = make_blobs(48.0, sigma);
    const cv::Mat grey = render(blobs, 48.0);
    cv::Mat colour;
    cv::cvtColor(grey, colour, cv::COLOR_GRAY2BGR);
    SiftOptions options;
    options.max_image_size = 200;  // 433 -> 200, not a whole ratio
    const auto features = extract_sift(grey, colour, options);
    ASSERT_TRUE(features);
    const Deviation deviation = measure(blobs, features->keypoints);
    EXPECT_GE(deviation.found, 60U);
    EXPECT_LT(deviation.mean.cwiseAbs().maxCoeff(), 0.03) << deviation.mean.transpose();
    EXPECT_NEAR(deviation.scale_ratio, kScaleRatio, 0.05);
}

}  // namespace
}  // namespace psfm
