// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "graph/camera.h"

#include <gtest/gtest.h>

#include <limits>
#include <ostream>
#include <string>
#include <vector>

#include "graph/camera_lens.h"

namespace psfm {
namespace {

struct NamedCamera {
    std::string name;
    Camera camera;
};

void PrintTo(const NamedCamera& camera, std::ostream* stream) {
    *stream << camera.name;
}

Camera camera_of(CameraModel model, std::array<double, 8> params) {
    return {.model = model, .width = 1000, .height = 750, .params = params};
}

/// Every model, without, with mild and with strong distortion (both barrel and pincushion).
std::vector<NamedCamera> cameras() {
    return {
        {"SimplePinhole", camera_of(CameraModel::kSimplePinhole, {900, 510, 370})},
        {"Pinhole", camera_of(CameraModel::kPinhole, {900, 920, 510, 370})},
        {"SimpleRadialNone", camera_of(CameraModel::kSimpleRadial, {900, 510, 370})},
        {"SimpleRadialMild", camera_of(CameraModel::kSimpleRadial, {900, 510, 370, -0.05})},
        {"SimpleRadialBarrel", camera_of(CameraModel::kSimpleRadial, {900, 510, 370, -0.27})},
        {"SimpleRadialPincushion", camera_of(CameraModel::kSimpleRadial, {900, 510, 370, 0.6})},
        {"RadialBarrel", camera_of(CameraModel::kRadial, {700, 510, 370, -0.35, 0.12})},
        {"RadialPincushion", camera_of(CameraModel::kRadial, {700, 510, 370, 0.2, 0.3})},
        {"OpenCv",
         camera_of(CameraModel::kOpenCv, {800, 810, 510, 370, -0.25, 0.08, 0.004, -0.006})},
    };
}

class CameraModels : public testing::TestWithParam<NamedCamera> {};

TEST_P(CameraModels, IsValid) {
    EXPECT_TRUE(validate(GetParam().camera).ok());
}

TEST_P(CameraModels, EveryPixelGoesToARayAndBack) {
    const Camera& camera = GetParam().camera;
    double worst_px = 0.0;
    for (std::uint32_t y = 0; y <= camera.height; y += 10) {
        for (std::uint32_t x = 0; x <= camera.width; x += 10) {
            const Eigen::Vector2d pixel(x, y);
            const Eigen::Vector2d back =
                pixel_from_normalized(camera, normalized_from_pixel(camera, pixel));
            worst_px = std::max(worst_px, (back - pixel).norm());
        }
    }
    EXPECT_LT(worst_px, 1e-7);
}

TEST_P(CameraModels, RaysInViewGoToAPixelAndBack) {
    // Not only some ray of the same pixel: the one that it came from, not one beyond the fold of a
    // barrel.
    const Camera& camera = GetParam().camera;
    for (double y = -0.4; y <= 0.4; y += 0.05) {
        for (double x = -0.5; x <= 0.5; x += 0.05) {
            const Eigen::Vector2d normalized(x, y);
            const Eigen::Vector2d back =
                normalized_from_pixel(camera, pixel_from_normalized(camera, normalized));
            EXPECT_LT((back - normalized).norm(), 1e-10) << normalized.transpose();
        }
    }
}

TEST_P(CameraModels, ProjectsTheAxisToThePrincipalPoint) {
    const Camera& camera = GetParam().camera;
    const auto pixel = project(camera, {0, 0, 3});
    ASSERT_TRUE(pixel.has_value());
    EXPECT_LT((*pixel - Eigen::Vector2d(510, 370)).norm(), 1e-12);
    EXPECT_EQ(camera.principal_point(), Eigen::Vector2d(510, 370));
}

TEST_P(CameraModels, ProjectionDependsOnTheDirectionOnly) {
    const Camera& camera = GetParam().camera;
    const Eigen::Vector3d point(0.3, -0.2, 1.5);
    EXPECT_LT((*project(camera, point) - *project(camera, 7.0 * point)).norm(), 1e-10);
}

TEST_P(CameraModels, SeesNothingBehind) {
    EXPECT_FALSE(project(GetParam().camera, {0.1, 0.1, -1.0}).has_value());
    EXPECT_FALSE(project(GetParam().camera, {0.1, 0.1, 0.0}).has_value());
}

TEST_P(CameraModels, IsItsMatrixNearTheAxis) {
    // Distortion is of third order (tangential: of second), so it vanishes near the axis.
    const Camera& camera = GetParam().camera;
    const Eigen::Vector3d near_axis(1e-4, -2e-4, 1.0);
    const Eigen::Vector2d linear = (camera.matrix() * near_axis).head<2>();
    EXPECT_LT((*project(camera, near_axis) - linear).norm(), 1e-5);
}

INSTANTIATE_TEST_SUITE_P(All, CameraModels, testing::ValuesIn(cameras()),
                         [](const auto& test) { return test.param.name; });

TEST(Camera, DistortsByHand) {
    // r2 = 0.25; SIMPLE_RADIAL: x * (1 - 0.1 * 0.25).
    const Camera simple = camera_of(CameraModel::kSimpleRadial, {1000, 500, 375, -0.1});
    EXPECT_LT((pixel_from_normalized(simple, {0.3, 0.4}) - Eigen::Vector2d(792.5, 765)).norm(),
              1e-9);
    // RADIAL adds k2 * r2^2 = 0.2 * 0.0625.
    const Camera radial = camera_of(CameraModel::kRadial, {1000, 500, 375, -0.1, 0.2});
    EXPECT_LT((pixel_from_normalized(radial, {0.3, 0.4}) - Eigen::Vector2d(796.25, 770)).norm(),
              1e-9);
    // OPENCV's tangential part: 2 p1 x y + p2 (r2 + 2 x^2), 2 p2 x y + p1 (r2 + 2 y^2).
    const Camera opencv = camera_of(CameraModel::kOpenCv, {1000, 2000, 500, 375, 0, 0, 0.01, 0.02});
    const Eigen::Vector2d expected(500 + 1000 * (0.3 + 0.0024 + 0.0086),
                                   375 + 2000 * (0.4 + 0.0048 + 0.0057));
    EXPECT_LT((pixel_from_normalized(opencv, {0.3, 0.4}) - expected).norm(), 1e-9);
}

TEST(Camera, PixelsThatNoRayReachesStayFinite) {
    // With this much barrel distortion nothing is seen further than 633 px from the middle.
    const Camera camera = camera_of(CameraModel::kSimpleRadial, {900, 510, 370, -0.30});
    for (const Eigen::Vector2d& pixel :
         {Eigen::Vector2d(0, 0), Eigen::Vector2d(-100, -100), Eigen::Vector2d(3000, 3000)}) {
        EXPECT_TRUE(normalized_from_pixel(camera, pixel).allFinite()) << pixel.transpose();
    }
}

TEST(Camera, MakeCameraIsCentredAndUndistorted) {
    const Camera camera = make_camera(640, 480, 500.0, FocalSource::kExif);
    EXPECT_EQ(camera.model, CameraModel::kSimpleRadial);
    EXPECT_EQ(camera.principal_point(), Eigen::Vector2d(320, 240));
    EXPECT_EQ(camera.fx(), 500.0);
    EXPECT_EQ(camera.fy(), 500.0);
    EXPECT_EQ(camera.params[3], 0.0);
    EXPECT_EQ(camera.focal_source, FocalSource::kExif);
    EXPECT_TRUE(validate(camera).ok());
}

TEST(Camera, FocalLengthsOfBothAxes) {
    const Camera camera = camera_of(CameraModel::kOpenCv, {800, 820, 510, 370});
    EXPECT_TRUE(camera.has_two_focals());
    EXPECT_EQ(camera.fx(), 800.0);
    EXPECT_EQ(camera.fy(), 820.0);
    EXPECT_EQ(camera.mean_focal(), 810.0);
    EXPECT_FALSE(camera_of(CameraModel::kRadial, {800, 510, 370}).has_two_focals());
}

TEST(CameraModelNames, AreColmapsAndGoBothWays) {
    const std::vector<std::pair<CameraModel, std::string>> names{
        {CameraModel::kSimplePinhole, "SIMPLE_PINHOLE"},
        {CameraModel::kPinhole, "PINHOLE"},
        {CameraModel::kSimpleRadial, "SIMPLE_RADIAL"},
        {CameraModel::kRadial, "RADIAL"},
        {CameraModel::kOpenCv, "OPENCV"}};
    const std::vector<int> colmap_parameters{3, 4, 4, 5, 8};
    for (std::size_t i = 0; i < names.size(); ++i) {
        EXPECT_EQ(static_cast<std::size_t>(names[i].first), i)
            << "COLMAP's numbers are stored in files";
        EXPECT_EQ(model_name(names[i].first), names[i].second);
        EXPECT_EQ(model_from_name(names[i].second), names[i].first);
        EXPECT_EQ(parameter_count(names[i].first), colmap_parameters[i]);
    }
    EXPECT_FALSE(model_from_name("FISHEYE").has_value());
    EXPECT_FALSE(model_from_name("").has_value());
    EXPECT_FALSE(model_from_name("pinhole").has_value());
}

TEST(CameraValidate, RefusesWhatCannotBeACamera) {
    const Camera good = make_camera(640, 480, 500.0, FocalSource::kGiven);
    const auto refused = [](const Camera& camera) {
        const auto valid = validate(camera);
        return !valid.ok() && valid.error().code == ErrorCode::kInvalidArgument &&
               !valid.error().message.empty();
    };
    EXPECT_FALSE(refused(good));
    Camera bad = good;
    bad.width = 0;
    EXPECT_TRUE(refused(bad));
    bad = good;
    bad.height = 0;
    EXPECT_TRUE(refused(bad));
    bad = good;
    bad.params[0] = -500.0;
    EXPECT_TRUE(refused(bad));
    bad.params[0] = 79.0;  // the diagonal is 800
    EXPECT_TRUE(refused(bad));
    bad.params[0] = 81.0;
    EXPECT_FALSE(refused(bad));
    bad.params[0] = 80001.0;
    EXPECT_TRUE(refused(bad));
    bad = good;
    bad.params[3] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_TRUE(refused(bad));
    bad.params[3] = std::numeric_limits<double>::infinity();
    EXPECT_TRUE(refused(bad));
    bad = good;
    bad.model = static_cast<CameraModel>(77);
    EXPECT_TRUE(refused(bad));
    bad = camera_of(CameraModel::kPinhole, {900, 0, 510, 370});
    EXPECT_TRUE(refused(bad)) << "the second focal length counts too";
}

TEST(CameraTest, TheLensOfAnotherCameraLeavesThePrincipalPoint) {
    Camera portrait = make_camera(300, 400, 500, FocalSource::kUnknown);
    Camera landscape = make_camera(400, 300, 520, FocalSource::kEstimated);
    landscape.params = {520, 203, 148, -0.07};
    const Camera result = with_lens_of(portrait, landscape);
    EXPECT_EQ(result.fx(), 520.0);
    EXPECT_EQ(result.params[3], -0.07);
    EXPECT_EQ(result.principal_point(), Eigen::Vector2d(150, 200));
    EXPECT_EQ(result.width, 300U);
    EXPECT_EQ(result.focal_source, FocalSource::kEstimated);
}

}  // namespace
}  // namespace psfm
