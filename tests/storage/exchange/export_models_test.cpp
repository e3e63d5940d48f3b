// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/exchange/models/export_models.h"

#include <gtest/gtest.h>

namespace psfm {
namespace {

constexpr ImageId image_id(std::uint32_t i) {
    return static_cast<ImageId>(i);
}
constexpr CameraId camera_id(std::uint32_t i) {
    return static_cast<CameraId>(i);
}

std::vector<Image> session_images(std::uint32_t count) {
    std::vector<Image> images;
    for (std::uint32_t i = 0; i < count; ++i) {
        images.push_back({image_id(i), camera_id(0), "photo" + std::to_string(i) + ".jpg", {}});
    }
    return images;
}

/// Cluster `id` with images `first` … last, one point that all of them observe with feature 2,
/// camera 0.
std::shared_ptr<SceneCluster> cluster(std::uint32_t id, std::uint32_t first, std::uint32_t last,
                                      std::uint32_t effective, double focal) {
    auto model = std::make_shared<Reconstruction>();
    model->cameras[camera_id(0)] = make_camera(1000, 800, focal, FocalSource::kEstimated);
    ScenePoint point;
    point.position = {1, 2, 3};
    point.error_px = 0.5F;
    for (std::uint32_t i = first; i <= last; ++i) {
        model->images.push_back(
            {image_id(i),
             camera_id(0),
             {Eigen::Quaterniond(0.5, 0.5, 0.5, 0.5), Eigen::Vector3d(i, 0, 1)}});
        point.track.push_back({image_id(i), 2});
    }
    model->points = std::vector{point};
    auto result = std::make_shared<SceneCluster>();
    result->id = static_cast<ClusterId>(id);
    result->model = model;
    result->effective_cluster = effective;
    return result;
}

Result<std::shared_ptr<const Keypoints>> four_keypoints(ImageId image) {
    Keypoints keypoints(4);
    for (std::size_t k = 0; k < 4; ++k)
        keypoints[k].x = static_cast<float>(10 * index_of(image) + k);
    keypoints[2].red = static_cast<std::uint8_t>(100 + index_of(image));
    keypoints[2].blue = 255;
    return std::make_shared<const Keypoints>(keypoints);
}

TEST(ExportModels, OneModelAnEffectiveClusterLargestFirst) {
    Scene scene;
    scene.clusters = {cluster(0, 0, 2, 1, 900), cluster(3, 3, 9, 0, 900),
                      cluster(4, 10, 11, 1, 900)};
    auto unsolved = std::make_shared<SceneCluster>();
    scene.clusters.push_back(unsolved);
    const auto models = export_models(scene, session_images(12), four_keypoints);
    ASSERT_TRUE(models.ok()) << models.error().message;
    ASSERT_EQ(models->size(), 2U);
    EXPECT_EQ(models->at(0).images.size(), 7U);
    EXPECT_EQ(models->at(1).images.size(), 5U);
    EXPECT_EQ(models->at(1).images[3].id, 11U);
    EXPECT_EQ(models->at(1).images[3].name, "photo10.jpg");
    ASSERT_EQ(models->at(1).points.size(), 2U);  // points of different clusters stay apart
    EXPECT_EQ(models->at(1).points[1].id, 2U);
    EXPECT_EQ(models->at(1).points[1].track, (std::vector<ExportedObservation>{{11, 2}, {12, 2}}));
    EXPECT_TRUE(export_models(Scene{}, {}, four_keypoints)->empty());
}

TEST(ExportModels, PosesAndPointsGoIntoTheWorldTogether) {
    auto moved = cluster(0, 0, 2, 0, 900);
    moved->world_from_cluster = {
        2.5, Eigen::Quaterniond(0.1, -0.7, 0.5, 0.5).normalized(), {4, 5, 6}};
    Scene scene;
    scene.clusters = {moved};
    const auto models = export_models(scene, session_images(3), four_keypoints);
    ASSERT_TRUE(models.ok());
    const ExportedModel& model = models->front();
    for (const ExportedImage& image : model.images) {
        const Rigid3& before = moved->model->images[image.id - 1].cam_from_cluster;
        // The same point in the same direction, 2.5 times as far: pixels stay.
        EXPECT_TRUE((image.cam_from_world * model.points[0].position)
                        .isApprox(2.5 * (before * moved->model->points[0].position), 1e-12));
    }
}

TEST(ExportModels, FeaturesColoursAndErrors) {
    Scene scene;
    scene.clusters = {cluster(0, 0, 2, 0, 900)};
    const auto all = export_models(scene, session_images(3), four_keypoints);
    ASSERT_TRUE(all.ok());
    ASSERT_EQ(all->front().images[1].keypoints.size(), 4U);
    EXPECT_EQ(all->front().images[1].keypoints[2], (ExportedKeypoint{12.0, 0.0, 1}));
    EXPECT_EQ(all->front().images[1].keypoints[0].point, kNoPoint);
    EXPECT_EQ(all->front().points[0].rgb, (std::array<std::uint8_t, 3>{101, 0, 255}));
    EXPECT_EQ(all->front().points[0].error_px, 0.5);

    const auto colours =
        export_models(scene, session_images(3), four_keypoints, FeatureUse::kColoursOnly);
    EXPECT_TRUE(colours->front().images[1].keypoints.empty());
    EXPECT_EQ(colours->front().points[0].rgb[0], 101);

    const auto none = export_models(scene, session_images(3), {}, FeatureUse::kNone);
    ASSERT_TRUE(none.ok());
    EXPECT_EQ(none->front().points[0].track.size(), 3U);
}

TEST(ExportModels, DifferentEstimatesOfACameraAreDifferentCameras) {
    Scene scene;
    scene.clusters = {cluster(0, 0, 2, 0, 900), cluster(1, 3, 5, 0, 910), cluster(2, 6, 8, 0, 900)};
    auto second = std::make_shared<Reconstruction>(*scene.clusters[1]->model);
    second->cameras[camera_id(4)] = make_camera(640, 480, 700, FocalSource::kExif);
    second->images[1].camera = camera_id(4);
    auto changed = std::make_shared<SceneCluster>(*scene.clusters[1]);
    changed->model = second;
    scene.clusters[1] = changed;
    const auto models = export_models(scene, session_images(9), four_keypoints);
    ASSERT_TRUE(models.ok());
    const ExportedModel& model = models->front();
    ASSERT_EQ(model.cameras.size(), 3U);
    EXPECT_EQ(model.cameras[0].id, 1U);  // camera 0, first estimate
    EXPECT_EQ(model.cameras[1].id, 5U);  // camera 4
    EXPECT_EQ(model.cameras[2].id, 6U);  // camera 0 again, with an id that is no camera's
    EXPECT_EQ(model.cameras[2].camera.fx(), 910.0);
    EXPECT_EQ(model.images[0].camera_id, 1U);
    EXPECT_EQ(model.images[3].camera_id, 6U);
    EXPECT_EQ(model.images[4].camera_id, 5U);
    EXPECT_EQ(model.images[7].camera_id, 1U);
}

TEST(ExportModels, ImageInTwoClustersIsExportedOnce) {
    Scene scene;
    scene.clusters = {cluster(0, 0, 3, 0, 900), cluster(1, 3, 4, 0, 900)};
    const auto models = export_models(scene, session_images(5), four_keypoints);
    ASSERT_TRUE(models.ok());
    EXPECT_EQ(models->front().images.size(), 5U);
    EXPECT_EQ(models->front().points.size(),
              1U);  // the second cluster's point keeps one observation
}

TEST(ExportModels, ProblemsAreNamed) {
    Scene scene;
    scene.clusters = {cluster(0, 0, 2, 0, 900)};
    EXPECT_EQ(export_models(scene, session_images(2), four_keypoints).error().code,
              ErrorCode::kInvalidArgument);
    const KeypointsProvider too_few = [](ImageId) -> Result<std::shared_ptr<const Keypoints>> {
        return std::make_shared<const Keypoints>(Keypoints(2));
    };
    const auto damaged = export_models(scene, session_images(3), too_few);
    EXPECT_EQ(damaged.error().code, ErrorCode::kDamaged);
    EXPECT_NE(damaged.error().message.find("photo0.jpg"), std::string::npos);
    const KeypointsProvider failing = [](ImageId) -> Result<std::shared_ptr<const Keypoints>> {
        return Error{ErrorCode::kIo, "gone"};
    };
    EXPECT_EQ(export_models(scene, session_images(3), failing).error().message, "gone");
}

}  // namespace
}  // namespace psfm
