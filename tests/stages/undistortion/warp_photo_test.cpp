// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/undistortion/warp_photo.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace psfm {
namespace {

/// Round blobs whose centres are where `places` says [px, origin at the corner].
cv::Mat photo_of_blobs(const Camera& camera, const std::vector<Eigen::Vector2d>& places) {
    cv::Mat photo(static_cast<int>(camera.height), static_cast<int>(camera.width), CV_8UC3);
    for (int y = 0; y < photo.rows; ++y) {
        for (int x = 0; x < photo.cols; ++x) {
            double value = 20;
            for (const Eigen::Vector2d& place : places) {
                const double r2 = (Eigen::Vector2d(x + 0.5, y + 0.5) - place).squaredNorm();
                value += 200 * std::exp(-r2 / (2 * 4.0 * 4.0));
            }
            photo.at<cv::Vec3b>(y, x) = cv::Vec3b::all(cv::saturate_cast<std::uint8_t>(value));
        }
    }
    return photo;
}

/// Centre of the brightness about a place.
Eigen::Vector2d centre_near(const cv::Mat& picture, const Eigen::Vector2d& place) {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    double weight = 0;
    for (int y = static_cast<int>(place.y()) - 14; y <= place.y() + 14; ++y) {
        for (int x = static_cast<int>(place.x()) - 14; x <= place.x() + 14; ++x) {
            const double value = std::max(0, picture.at<cv::Vec3b>(y, x)[0] - 24);
            sum += value * Eigen::Vector2d(x + 0.5, y + 0.5);
            weight += value;
        }
    }
    return sum / weight;
}

TEST(WarpPhoto, BlobsGoWhereFeaturesGo) {
    Camera camera = make_camera(400, 300, 350.0, FocalSource::kExif);
    camera.params = {350, 204, 147, -0.12};
    const std::vector<Eigen::Vector2d> places{
        {60, 50}, {340, 60}, {200, 150}, {90, 250}, {330, 240}};
    const cv::Mat photo = photo_of_blobs(camera, places);
    for (std::uint8_t turns = 0; turns < 4; ++turns) {
        for (const std::uint32_t max_size : {0U, 300U, 180U}) {
            UndistortedViewOptions options;
            options.max_size = max_size;
            const auto view = make_undistorted_view(camera, turns, options);
            ASSERT_TRUE(view);
            const cv::Mat picture = warp_photo(photo, *view);
            ASSERT_EQ(picture.cols, static_cast<int>(view->picture.width));
            ASSERT_EQ(picture.rows, static_cast<int>(view->picture.height));
            for (const Eigen::Vector2d& place : places) {
                const Eigen::Vector2d expected = picture_from_photo(*view, place);
                EXPECT_LT((centre_near(picture, expected) - expected).norm(), 0.12)
                    << "turns " << int{turns} << ", max " << max_size << ", at "
                    << expected.transpose();
            }
        }
    }
}

TEST(WarpPhoto, NothingOfAWhitePhotographIsBlank) {
    for (const double k : {-0.2, -0.05, 0.05, 0.2}) {
        Camera camera = make_camera(320, 240, 260.0, FocalSource::kExif);
        camera.params[3] = k;
        const cv::Mat photo(240, 320, CV_8UC3, cv::Scalar::all(255));
        const auto view = make_undistorted_view(camera, 0, {});
        ASSERT_TRUE(view);
        double least = 0;
        cv::minMaxLoc(warp_photo(photo, *view).reshape(1), &least);
        EXPECT_EQ(least, 255.0) << k;
    }
}

TEST(WarpPhoto, WithAllOfThePhotographTheRestIsBlack) {
    Camera camera = make_camera(320, 240, 260.0, FocalSource::kExif);
    camera.params[3] = -0.1;
    const cv::Mat photo(240, 320, CV_8UC3, cv::Scalar::all(255));
    UndistortedViewOptions options;
    options.blank_pixels = 1.0;
    const auto view = make_undistorted_view(camera, 0, options);
    ASSERT_TRUE(view);
    const cv::Mat picture = warp_photo(photo, *view);
    EXPECT_EQ(picture.at<cv::Vec3b>(0, picture.cols / 2)[1], 0);
    EXPECT_EQ(picture.at<cv::Vec3b>(picture.rows / 2, picture.cols / 2)[1], 255);
}

TEST(WarpPhoto, FinePatternsAreAveragedWhenReduced) {
    const Camera camera = make_camera(400, 400, 400.0, FocalSource::kExif);
    cv::Mat photo(400, 400, CV_8UC3);
    for (int y = 0; y < 400; ++y) {
        for (int x = 0; x < 400; ++x)
            photo.at<cv::Vec3b>(y, x) = cv::Vec3b::all((x + y) % 2 == 0 ? 0 : 200);
    }
    UndistortedViewOptions options;
    options.max_size = 100;
    const auto view = make_undistorted_view(camera, 0, options);
    ASSERT_TRUE(view);
    cv::Scalar mean;
    cv::Scalar deviation;
    cv::meanStdDev(warp_photo(photo, *view), mean, deviation);
    EXPECT_NEAR(mean[0], 100, 2);
    EXPECT_LT(deviation[0], 2);
}

}  // namespace
}  // namespace psfm
