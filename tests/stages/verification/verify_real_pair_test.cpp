// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <opencv2/features2d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "stages/algorithms/matching/match_descriptors.h"
#include "stages/verification/verify_pair.h"
#include "tests/stages/verification/two_views.h"

namespace psfm {
namespace {

struct Photo {
    Keypoints keypoints;
    Descriptors descriptors;
};

/// SIFT as bytes of RootSIFT (graph/image.h), with OpenCV alone: the features stage has its own
/// tests.
Photo extract(const std::string& file) {
    const cv::Mat grey = cv::imread(file, cv::IMREAD_GRAYSCALE);
    if (grey.empty()) return {};
    std::vector<cv::KeyPoint> points;
    cv::Mat rows;
    cv::SIFT::create(4000)->detectAndCompute(grey, cv::noArray(), points, rows);
    Photo photo;
    for (int i = 0; i < rows.rows; ++i) {
        const auto& point = points[static_cast<std::size_t>(i)];
        photo.keypoints.push_back(test::keypoint_at({point.pt.x + 0.25, point.pt.y + 0.25}));
        const double sum = cv::sum(rows.row(i))[0];
        for (int j = 0; j < rows.cols; ++j) {
            const double root = std::sqrt(rows.at<float>(i, j) / sum);
            photo.descriptors.values.push_back(
                static_cast<std::uint8_t>(std::min(255.0, std::round(512 * root))));
        }
    }
    return photo;
}

/// Two neighbours of fountain-P11 against the laser scanner's truth (gt/images.txt, images 5 and
/// 6).
TEST(VerifyRealPair, NeighboursOfTheFountain) {
    const char* datasets = std::getenv("PSFM_DATASETS");
    if (!datasets) GTEST_SKIP() << "PSFM_DATASETS is not set";
    const std::string folder = std::string(datasets) + "/strecha-half/fountain-P11/images/";
    const Photo photo1 = extract(folder + "0004.jpg");
    const Photo photo2 = extract(folder + "0005.jpg");
    ASSERT_FALSE(photo1.keypoints.empty()) << "no photograph " << folder << "0004.jpg";
    ASSERT_FALSE(photo2.keypoints.empty()) << "no photograph " << folder << "0005.jpg";
    Camera camera;
    camera.model = CameraModel::kPinhole;
    camera.width = 1536;
    camera.height = 1024;
    camera.params = {1379.74, 1382.08, 760.595, 503.655};
    camera.focal_source = FocalSource::kGiven;
    const Rigid3 cam1_from_world{{0.6701082375, -0.7045444982, 0.1687071427, 0.1615855810},
                                 {9.3181037656, -0.5444752357, -9.0159943154}};
    const Rigid3 cam2_from_world{{0.6839589717, -0.7166387688, 0.0999298504, 0.0929678708},
                                 {12.7345628515, -0.4609886629, -7.0121818301}};
    const Rigid3 truth = cam2_from_world * inverse(cam1_from_world);

    const std::vector<FeatureMatch> matches =
        match_descriptors(photo1.descriptors, photo2.descriptors, {});
    const Result<TwoViewGeometry> geometry =
        verify_pair({photo1.keypoints, photo2.keypoints, camera, camera, matches}, {}, 1);
    ASSERT_TRUE(geometry.ok()) << geometry.error().message;
    EXPECT_EQ(geometry->kind, TwoViewKind::kEssential);
    EXPECT_GT(geometry->inliers.size(), 500U);
    EXPECT_LT(test::rotation_error_deg(geometry->cam2_from_cam1, truth), 0.15);
    EXPECT_LT(test::direction_error_deg(geometry->cam2_from_cam1, truth), 0.3);
    EXPECT_NEAR(geometry->median_angle_deg, 11.4, 1.0);
}

}  // namespace
}  // namespace psfm
