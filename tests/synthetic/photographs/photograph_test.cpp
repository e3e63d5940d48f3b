// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/synthetic/photographs/photograph.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "tests/synthetic/photographs/render.h"
#include "tests/synthetic/scene.h"
#include "tests/synthetic/verified_pairs.h"

namespace psfm::synthetic {
namespace {

PhotographOptions perfect_sensor() {
    return {.noise_sigma = 0.0, .exposure_sigma = 0.0, .corner_darkening = 0.0};
}

/// A white wall y = 0, 8 m by 6 m, with black squares of 4 cm every metre.
PhotoWorld wall_of_squares() {
    constexpr int kTexelsPerMetre = 128;
    cv::Mat3b image(6 * kTexelsPerMetre, 8 * kTexelsPerMetre, cv::Vec3b(250, 250, 250));
    for (int y = 0; y < 6; ++y) {
        for (int x = 0; x < 8; ++x) {
            const cv::Point middle(x * kTexelsPerMetre + 64, y * kTexelsPerMetre + 64);
            image(cv::Rect(middle.x - 3, middle.y - 3, 6, 6)).setTo(0);
        }
    }
    PaintedRectangle wall{.corner = {-4, 0, -3},
                          .u_axis = Eigen::Vector3d::UnitX(),
                          .v_axis = Eigen::Vector3d::UnitZ(),
                          .width = 8.0,
                          .height = 6.0,
                          .levels = {image}};
    while (wall.levels.size() < 5) {
        cv::Mat half;
        cv::resize(wall.levels.back(), half, {}, 0.5, 0.5, cv::INTER_AREA);
        wall.levels.push_back(half);
    }
    return {.rectangles = {wall}, .to_sun = Eigen::Vector3d::UnitZ()};
}

/// Where the darkness near a pixel has its middle; the centre of pixel (0, 0) is (0.5, 0.5).
Eigen::Vector2d dark_centroid(const cv::Mat& image, const Eigen::Vector2d& near) {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    double weight = 0.0;
    const auto left = static_cast<int>(near.x());
    const auto top = static_cast<int>(near.y());
    for (int y = top - 9; y <= top + 9; ++y) {
        for (int x = left - 9; x <= left + 9; ++x) {
            const double dark = 250.0 - image.at<cv::Vec3b>(y, x)[1];
            sum += dark * Eigen::Vector2d(x + 0.5, y + 0.5);
            weight += dark;
        }
    }
    return sum / weight;
}

class Exactness : public testing::TestWithParam<CameraModel> {};

TEST_P(Exactness, PointsAreWhereTheCameraModelSays) {
    Camera camera = make_camera(800, 600, 700.0, FocalSource::kGiven);
    camera.model = GetParam();
    switch (camera.model) {
        case CameraModel::kSimpleRadial:
            camera.params = {700, 410, 290, -0.1};
            break;
        case CameraModel::kOpenCv:
            camera.params = {700, 690, 410, 290, -0.1, 0.02, 0.002, -0.003};
            break;
        default:
            camera.params = {700, 690, 410, 290};
            break;
    }
    const PhotoWorld world = wall_of_squares();
    const SightLines sight = make_sight_lines(camera);
    std::size_t measured = 0;
    for (const Eigen::Vector3d& centre : {Eigen::Vector3d(0, -5, 0), Eigen::Vector3d(1.5, -5, 1)}) {
        const Rigid3 pose = look_at(centre, {0.2, 0, -0.1});
        const cv::Mat image = take_photograph(world, sight, pose, perfect_sensor(), 1);
        for (double z = -2.5; z <= 2.5; z += 1.0) {
            for (double x = -3.5; x <= 3.5; x += 1.0) {
                const auto pixel = project(camera, pose * Eigen::Vector3d(x, 0, z));
                if (!pixel || pixel->x() < 12 || pixel->y() < 12 || pixel->x() > 788 ||
                    pixel->y() > 588) {
                    continue;
                }
                EXPECT_LT((dark_centroid(image, *pixel) - *pixel).norm(), 0.04)
                    << pixel->transpose();
                ++measured;
            }
        }
    }
    EXPECT_GT(measured, 50U);
}

INSTANTIATE_TEST_SUITE_P(Models, Exactness,
                         testing::Values(CameraModel::kPinhole, CameraModel::kSimpleRadial,
                                         CameraModel::kOpenCv),
                         [](const auto& test) { return std::string(model_name(test.param)); });

TEST(TakePhotograph, ShowsTheNearerOfTwoThingsAndSkyBeyond) {
    PhotoWorld world = wall_of_squares();
    PaintedRectangle board = world.rectangles[0];
    board.corner = {-1, -2, -1};
    board.width = board.height = 2.0;
    board.levels = {cv::Mat3b(64, 64, cv::Vec3b(10, 20, 200))};
    world.rectangles.push_back(board);
    const Camera camera = make_camera(400, 300, 200.0, FocalSource::kGiven);
    const Rigid3 pose = look_at({0, -6, 0}, {0, 0, 0});
    const cv::Mat image =
        take_photograph(world, make_sight_lines(camera), pose, perfect_sensor(), 1);
    EXPECT_EQ(image.at<cv::Vec3b>(150, 200), cv::Vec3b(10, 20, 200));
    EXPECT_GT(image.at<cv::Vec3b>(5, 200)[0], 200) << "the sky is bright";
    // The board ends 1 m from the axis at 4 m: 50 px from the middle.
    EXPECT_EQ(image.at<cv::Vec3b>(150, 248), cv::Vec3b(10, 20, 200));
    EXPECT_NE(image.at<cv::Vec3b>(150, 251), cv::Vec3b(10, 20, 200));
}

TEST(CastRay, FindsTheNearestFacingSurface) {
    const PhotoWorld world = wall_of_squares();
    const auto hit = cast_ray(world, {1, -5, 2}, {0, 2, 0});
    ASSERT_TRUE(hit.has_value());
    EXPECT_NEAR(hit->range, 2.5, 1e-12);
    EXPECT_NEAR(hit->u, 5.0, 1e-12);
    EXPECT_NEAR(hit->v, 5.0, 1e-12);
    EXPECT_TRUE(hit->position.isApprox(Eigen::Vector3d(1, 0, 2), 1e-12));
    EXPECT_FALSE(cast_ray(world, {1, 5, 2}, {0, -1, 0}).has_value()) << "seen from behind";
    EXPECT_FALSE(cast_ray(world, {1, -5, 2}, {0, -1, 0}).has_value()) << "behind the origin";
    EXPECT_FALSE(cast_ray(world, {5, -5, 2}, {0, 1, 0}).has_value()) << "beside it";
}

TEST(TakePhotograph, NoiseHasTheSizeAskedFor) {
    PhotoWorld world = wall_of_squares();
    world.rectangles[0].levels = {cv::Mat3b(64, 64, cv::Vec3b(100, 100, 100))};
    const SightLines sight = make_sight_lines(make_camera(200, 150, 200.0, FocalSource::kGiven));
    PhotographOptions options = perfect_sensor();
    options.noise_sigma = 3.0;
    const cv::Mat image = take_photograph(world, sight, look_at({0, -3, 0}, {0, 0, 0}), options, 1);
    cv::Scalar mean;
    cv::Scalar sigma;
    cv::meanStdDev(image, mean, sigma);
    EXPECT_NEAR(mean[1], 100.0, 0.2);
    EXPECT_NEAR(sigma[1], 3.0, 0.1);
    const cv::Mat again = take_photograph(world, sight, look_at({0, -3, 0}, {0, 0, 0}), options, 1);
    EXPECT_EQ(cv::norm(image, again, cv::NORM_INF), 0.0);
}

struct MatchQuality {
    std::size_t matches = 0;
    std::size_t right = 0;            ///< within 2 px of where the surface point projects to
    double epipolar_median_px = 0.0;  ///< of the right ones
    double epipolar_90_px = 0.0;
};

std::vector<cv::DMatch> mutual_ratio_matches(const cv::Mat& one, const cv::Mat& two) {
    const auto best = [](const cv::Mat& from, const cv::Mat& to) {
        std::vector<std::vector<cv::DMatch>> pairs;
        cv::BFMatcher(cv::NORM_L2).knnMatch(from, to, pairs, 2);
        std::vector<cv::DMatch> good;
        for (const auto& pair : pairs) {
            if (pair[0].distance < 0.8F * pair[1].distance) good.push_back(pair[0]);
        }
        return good;
    };
    std::vector<int> back(static_cast<std::size_t>(two.rows), -1);
    for (const cv::DMatch& match : best(two, one)) {
        back[static_cast<std::size_t>(match.queryIdx)] = match.trainIdx;
    }
    std::vector<cv::DMatch> mutual = best(one, two);
    std::erase_if(mutual, [&](const cv::DMatch& match) {
        return back[static_cast<std::size_t>(match.trainIdx)] != match.queryIdx;
    });
    return mutual;
}

/// SIFT's matches between two photographs, judged by the true surface.
MatchQuality match_quality(const PhotoSetOptions& options, std::size_t first, std::size_t second) {
    const PhotoPlan plan = plan_photographs(options, 1);
    const PhotoWorld world = make_photo_world(options.scene, options.texels_per_metre, 1);
    const SightLines sight = make_sight_lines(plan.camera);
    const std::array<Rigid3, 2> poses{plan.photos[first].cam_from_world,
                                      plan.photos[second].cam_from_world};
    std::array<std::vector<cv::KeyPoint>, 2> keypoints;
    std::array<cv::Mat, 2> descriptors;
    for (std::size_t i = 0; i < 2; ++i) {
        const cv::Mat image = take_photograph(world, sight, poses[i], options.photograph, 10 + i);
        cv::SIFT::create(3000)->detectAndCompute(image, {}, keypoints[i], descriptors[i]);
    }
    // OpenCV 4.6's SIFT is a quarter of a pixel off, and counts from the first pixel's centre
    // (docs/parts.md).
    const auto ray = [&](std::size_t i, int index) {
        const cv::Point2f at = keypoints[i][static_cast<std::size_t>(index)].pt;
        return normalized_from_pixel(plan.camera, {at.x + 0.25, at.y + 0.25});
    };
    const Eigen::Matrix3d essential = essential_matrix(poses[1] * inverse(poses[0]));
    const Eigen::Vector3d centre = poses[0].target_origin_in_source();
    MatchQuality quality;
    std::vector<double> errors_px;
    for (const cv::DMatch& match : mutual_ratio_matches(descriptors[0], descriptors[1])) {
        ++quality.matches;
        const Eigen::Vector2d x1 = ray(0, match.queryIdx);
        const Eigen::Vector2d x2 = ray(1, match.trainIdx);
        const auto hit = cast_ray(world, centre, poses[0].rotation.conjugate() * x1.homogeneous());
        if (!hit) continue;
        const Eigen::Vector3d expected = poses[1] * hit->position;
        if (expected.z() <= 0.0) continue;
        const double f = plan.camera.mean_focal();
        if ((expected.hnormalized() - x2).norm() * f > 2.0) continue;
        ++quality.right;
        const Eigen::Vector3d line = essential * x1.homogeneous();
        errors_px.push_back(std::abs(line.dot(x2.homogeneous())) / line.head<2>().norm() * f);
    }
    std::ranges::sort(errors_px);
    if (!errors_px.empty()) {
        quality.epipolar_median_px = errors_px[errors_px.size() / 2];
        quality.epipolar_90_px = errors_px[errors_px.size() * 9 / 10];
    }
    return quality;
}

void expect_good(const MatchQuality& quality, std::size_t least) {
    EXPECT_GT(quality.right, least);
    EXPECT_GT(static_cast<double>(quality.right), 0.8 * static_cast<double>(quality.matches));
    EXPECT_LT(quality.epipolar_median_px, 0.35);
    EXPECT_LT(quality.epipolar_90_px, 1.0);
    testing::Test::RecordProperty("matches", static_cast<int>(quality.matches));
    testing::Test::RecordProperty("right", static_cast<int>(quality.right));
}

TEST(Photographs, OfTheCourtyardMatchTheirNeighbours) {
    expect_good(match_quality({}, 4, 5), 400);
}

TEST(Photographs, OfTheWallMatchTheirNeighbours) {
    PhotoSetOptions options;
    options.scene = PhotoScene::kWall;
    options.images = 8;
    options.width = 640;
    options.height = 480;
    options.texels_per_metre = 120.0;
    expect_good(match_quality(options, 2, 3), 200);
}

}  // namespace
}  // namespace psfm::synthetic
