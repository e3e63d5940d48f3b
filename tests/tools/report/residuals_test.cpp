// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/report/residuals.h"

#include <gtest/gtest.h>

namespace psfm {
namespace {

/// Two cameras side by side that look at one point, whose features are off by known vectors.
struct TwoViews {
    Reconstruction model;
    std::map<ImageId, std::shared_ptr<const Keypoints>> keypoints;

    TwoViews() {
        const Camera camera = make_camera(1000, 800, 900.0, FocalSource::kGiven);
        model.cameras[CameraId{0}] = camera;
        const Eigen::Vector3d position(0.1, -0.2, 5.0);
        ScenePoint point;
        point.position = position;
        for (std::uint32_t i = 0; i < 2; ++i) {
            RegisteredImage image{ImageId{i}, CameraId{0}, {}};
            image.cam_from_cluster.translation = Eigen::Vector3d(-0.5 * i, 0.0, 0.0);
            const Eigen::Vector2d pixel = *project(camera, image.cam_from_cluster * position);
            Keypoints features(3);
            features[2].x = static_cast<float>(pixel.x() + 3.0 * i);
            features[2].y = static_cast<float>(pixel.y() - 4.0 * i);
            keypoints[image.image] = std::make_shared<const Keypoints>(features);
            point.track.push_back({image.image, 2});
            model.images.push_back(image);
        }
        model.points = ScenePoints({point});
    }
    KeypointsProvider provider() const {
        return [this](ImageId image) -> Result<std::shared_ptr<const Keypoints>> {
            return keypoints.at(image);
        };
    }
};

TEST(Residuals, AreObservedMinusProjected) {
    const TwoViews views;
    const auto residuals = residuals_of(views.model, views.provider());
    ASSERT_TRUE(residuals.ok());
    ASSERT_EQ(residuals->size(), 2U);
    ASSERT_EQ((*residuals)[1].size(), 1U);
    EXPECT_NEAR(mean_length_px((*residuals)[0]), 0.0, 1e-3);
    EXPECT_NEAR((*residuals)[1][0].difference_px.x(), 3.0, 1e-3);
    EXPECT_NEAR((*residuals)[1][0].difference_px.y(), -4.0, 1e-3);
    EXPECT_NEAR(mean_length_px((*residuals)[1]), 5.0, 1e-3);
}

TEST(Residuals, AFeatureThatIsNotThereIsDamage) {
    TwoViews views;
    views.keypoints[ImageId{1}] = std::make_shared<const Keypoints>(Keypoints(2));
    const auto residuals = residuals_of(views.model, views.provider());
    ASSERT_FALSE(residuals.ok());
    EXPECT_EQ(residuals.error().code, ErrorCode::kDamaged);
}

}  // namespace
}  // namespace psfm
