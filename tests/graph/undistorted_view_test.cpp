// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "graph/undistorted_view.h"

#include <gtest/gtest.h>

#include <cmath>

namespace psfm {
namespace {

Camera camera_of(CameraModel model) {
    Camera camera = make_camera(1200, 800, 1000.0, FocalSource::kExif);
    camera.model = model;
    switch (model) {
        case CameraModel::kSimplePinhole:
            camera.params = {1000, 605, 392};
            break;
        case CameraModel::kPinhole:
            camera.params = {1000, 990, 605, 392};
            break;
        case CameraModel::kSimpleRadial:
            camera.params = {1000, 605, 392, -0.08};
            break;
        case CameraModel::kRadial:
            camera.params = {1000, 605, 392, 0.06, -0.02};
            break;
        case CameraModel::kOpenCv:
            camera.params = {1000, 990, 605, 392, -0.1, 0.02, 1e-3, -2e-3};
            break;
    }
    return camera;
}

class EveryModel : public testing::TestWithParam<int> {
  protected:
    Camera camera_ = camera_of(static_cast<CameraModel>(GetParam()));
};
INSTANTIATE_TEST_SUITE_P(Models, EveryModel, testing::Range(0, 5));

TEST_P(EveryModel, ShowsNothingThatThePhotographHasNot) {
    for (std::uint8_t turns = 0; turns < 4; ++turns) {
        const auto view = make_undistorted_view(camera_, turns, {});
        ASSERT_TRUE(view) << view.error().message;
        const Camera& picture = view->picture;
        for (double part = 0.0; part <= 1.0; part += 1.0 / 64) {
            const double x = picture.width * part;
            const double y = picture.height * part;
            for (const Eigen::Vector2d& place :
                 {Eigen::Vector2d(x, 0), Eigen::Vector2d(x, picture.height), Eigen::Vector2d(0, y),
                  Eigen::Vector2d(picture.width, y)}) {
                const Eigen::Vector2d from = photo_from_picture(*view, place);
                EXPECT_GT(from.minCoeff(), -0.01) << place.transpose();
                EXPECT_LT(from.x(), camera_.width + 0.01) << place.transpose();
                EXPECT_LT(from.y(), camera_.height + 0.01) << place.transpose();
            }
        }
        // Not much is lost, either: nine tenths of each side at such distortions.
        const bool sideways = turns % 2 == 1;
        EXPECT_GT(sideways ? picture.height : picture.width, 0.9 * camera_.width);
        EXPECT_GT(sideways ? picture.width : picture.height, 0.9 * camera_.height);
        EXPECT_DOUBLE_EQ(picture.principal_point().x(), 0.5 * picture.width);
        EXPECT_DOUBLE_EQ(picture.principal_point().y(), 0.5 * picture.height);
    }
}

TEST_P(EveryModel, APointIsSeenWhereItsFeatureHasGone) {
    const Rigid3 cam_from_world{
        Eigen::Quaterniond(Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitY())), {0.3, -0.2, 4.0}};
    for (std::uint8_t turns = 0; turns < 4; ++turns) {
        for (const bool centred : {true, false}) {
            UndistortedViewOptions options;
            options.centred = centred;
            options.max_size = centred ? 500 : 0;
            options.multiple = 8;
            const auto view = make_undistorted_view(camera_, turns, options);
            ASSERT_TRUE(view) << view.error().message;
            EXPECT_EQ(view->picture.width % 8, 0U);
            EXPECT_EQ(view->picture.height % 8, 0U);
            const Rigid3 pose = turned_pose(cam_from_world, turns);
            for (const Eigen::Vector3d& point :
                 {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 0.4, 0.5),
                  Eigen::Vector3d(-0.7, 1, -0.2)}) {
                const auto feature = project(camera_, cam_from_world * point);
                const auto expected = project(view->picture, pose * point);
                ASSERT_TRUE(feature && expected);
                EXPECT_LT((picture_from_photo(*view, *feature) - *expected).norm(), 1e-6);
                EXPECT_LT((photo_from_picture(*view, *expected) - *feature).norm(), 1e-6);
            }
        }
    }
}

TEST(UndistortedView, AQuarterTurnClockwiseBringsTheLeftSideUp) {
    const Camera camera = camera_of(CameraModel::kPinhole);
    const auto view = make_undistorted_view(camera, 1, {});
    ASSERT_TRUE(view);
    const double row = camera.principal_point().y();
    const Eigen::Vector2d left = picture_from_photo(*view, {100, row});
    const Eigen::Vector2d right = picture_from_photo(*view, {1100, row});
    EXPECT_LT(left.y(), right.y());
    EXPECT_NEAR(left.x(), right.x(), 1e-9);
}

TEST(UndistortedView, OrientationsBringUpUp) {
    EXPECT_EQ(upright_quarter_turns(1), 0);
    EXPECT_EQ(upright_quarter_turns(2), 0);
    EXPECT_EQ(upright_quarter_turns(3), 2);
    EXPECT_EQ(upright_quarter_turns(4), 2);
    EXPECT_EQ(upright_quarter_turns(5), 1);
    EXPECT_EQ(upright_quarter_turns(6), 1);
    EXPECT_EQ(upright_quarter_turns(7), 3);
    EXPECT_EQ(upright_quarter_turns(8), 3);
    EXPECT_EQ(upright_quarter_turns(0), 0);
}

TEST(UndistortedView, WithoutDistortionNothingIsLostOrMoved) {
    Camera camera = make_camera(1201, 799, 1000.0, FocalSource::kExif);
    const auto view = make_undistorted_view(camera, 0, {});
    ASSERT_TRUE(view);
    EXPECT_TRUE(is_identity(*view));
    camera.params[3] = 1e-4;
    EXPECT_FALSE(is_identity(*make_undistorted_view(camera, 0, {})));
}

TEST(UndistortedView, SidesAreNoMultiplesOfMoreThanThereIs) {
    UndistortedViewOptions options;
    options.multiple = 4032;
    const auto view = make_undistorted_view(camera_of(CameraModel::kSimpleRadial), 0, options);
    ASSERT_FALSE(view);
    EXPECT_NE(view.error().message.find("multiples of 4032"), std::string::npos);
}

TEST(UndistortedView, BlankPixelsKeepAllOfThePhotograph) {
    const Camera camera = camera_of(CameraModel::kSimpleRadial);
    UndistortedViewOptions options;
    options.blank_pixels = 1.0;
    options.centred = false;
    const auto view = make_undistorted_view(camera, 0, options);
    ASSERT_TRUE(view);
    for (const Eigen::Vector2d& corner : {Eigen::Vector2d(0, 0), Eigen::Vector2d(1200, 0),
                                          Eigen::Vector2d(0, 800), Eigen::Vector2d(1200, 800)}) {
        const Eigen::Vector2d place = picture_from_photo(*view, corner);
        EXPECT_GT(place.minCoeff(), -1.0);
        EXPECT_LT(place.x(), view->picture.width + 1.0);
        EXPECT_LT(place.y(), view->picture.height + 1.0);
    }
}

TEST(UndistortedView, ADistortionThatFoldsWithinThePhotographIsRefusedWithARemedy) {
    Camera camera = make_camera(1200, 800, 700.0, FocalSource::kUnknown);
    // Nothing is seen beyond 0.65 focal lengths, and the photograph ends at 0.86.
    camera.params[3] = -0.35;
    const auto view = make_undistorted_view(camera, 0, {});
    ASSERT_FALSE(view);
    EXPECT_NE(view.error().message.find("--cameras"), std::string::npos) << view.error().message;
}

TEST(UndistortedView, DifferencesAreThoseOfThePhotographsPixels) {
    const Camera camera = camera_of(CameraModel::kSimpleRadial);
    const auto view = make_undistorted_view(camera, 0, {});
    ASSERT_TRUE(view);
    EXPECT_EQ(largest_difference_px(*view, camera, 0), 0.0);
    EXPECT_TRUE(std::isinf(largest_difference_px(*view, camera, 1)));
    Camera shifted = camera;
    shifted.params[1] += 0.25;
    EXPECT_NEAR(largest_difference_px(*view, shifted, 0), 0.25, 1e-9);
    Camera longer = camera;
    longer.params[0] *= 1.001;
    EXPECT_GT(largest_difference_px(*view, longer, 0), 0.5);
}

TEST(UndistortedView, RefusesWhatIsNoCamera) {
    Camera camera = make_camera(1200, 800, 1000.0, FocalSource::kExif);
    camera.params[1] = 5000.0;  // the optical axis is outside of the photograph
    const auto view = make_undistorted_view(camera, 0, {});
    ASSERT_FALSE(view);
    EXPECT_NE(view.error().message.find("1200x800"), std::string::npos);
    EXPECT_FALSE(make_undistorted_view(make_camera(1200, 800, 1000.0, FocalSource::kExif), 4, {}));
}

}  // namespace
}  // namespace psfm
