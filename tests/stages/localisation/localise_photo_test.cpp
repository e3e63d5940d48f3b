// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/localisation/localise_photo.h"

#include <gtest/gtest.h>

#include "tests/synthetic/rng.h"

namespace psfm {
namespace {

const Camera kCamera = make_camera(1000, 800, 900.0, FocalSource::kExif);

/// Points with a descriptor each, seen by a row of cameras; a second, separate part whose points
/// look the same in every third place.
class LocalisePhotoTest : public testing::Test {
  protected:
    static constexpr std::uint32_t kPoints = 300;
    static constexpr std::uint32_t kImages = 8;

    LocalisePhotoTest() {
        synthetic::Rng rng(5);
        for (std::uint32_t p = 0; p < 2 * kPoints; ++p) {
            points_.push_back(rng.normal3() + (p < kPoints ? Eigen::Vector3d(0, 0, 0)
                                                           : Eigen::Vector3d(100, 0, 0)));
            const bool repeats = p >= kPoints && p % 3 == 0;
            descriptors_.push_back(repeats ? descriptors_[p - kPoints] : random_row(rng));
        }
        auto scene = std::make_shared<Scene>();
        for (std::uint32_t part = 0; part < 2; ++part) {
            auto cluster = std::make_shared<SceneCluster>();
            cluster->id = ClusterId{part};
            cluster->effective_cluster = part;
            auto model = std::make_shared<Reconstruction>();
            model->cameras[CameraId{0}] = kCamera;
            std::vector<ScenePoint> points(kPoints);
            for (std::uint32_t p = 0; p < kPoints; ++p)
                points[p].position = points_[part * kPoints + p];
            for (std::uint32_t k = 0; k < kImages; ++k) {
                const ImageId image{part * kImages + k};
                model->images.push_back({image, CameraId{0}, pose(part, 0.3 * k - 1.0)});
                for (std::uint32_t p = 0; p < kPoints; ++p) points[p].track.push_back({image, p});
            }
            model->points = points;
            cluster->model = model;
            scene->clusters.push_back(cluster);
        }
        map_ = std::make_unique<LocalisationMap>(*scene);
        for (const auto& [image, place] : map_->places())
            map_->add(image, *descriptors_of(image), {});
        map_->finish();
    }

    static Rigid3 pose(std::uint32_t part, double x) {
        Rigid3 pose{Eigen::Quaterniond(Eigen::AngleAxisd(0.1 * x, Eigen::Vector3d::UnitY())),
                    {x, 0.1, 7.0}};
        pose.translation -= pose.rotation * Eigen::Vector3d(100.0 * part, 0, 0);
        return pose;
    }

    static std::vector<std::uint8_t> random_row(synthetic::Rng& rng) {
        std::vector<double> values(Descriptors::kSize);
        double sum = 0;
        for (double& value : values) sum += value = std::pow(rng.uniform(), 3);
        std::vector<std::uint8_t> row;
        for (const double value : values)
            row.push_back(static_cast<std::uint8_t>(
                std::min(255.0, std::round(512 * std::sqrt(value / sum)))));
        return row;
    }

    std::shared_ptr<const Descriptors> descriptors_of(ImageId image) const {
        const std::uint32_t part = index_of(image) / kImages;
        auto descriptors = std::make_shared<Descriptors>();
        for (std::uint32_t p = 0; p < kPoints; ++p) {
            const auto& row = descriptors_[part * kPoints + p];
            descriptors->values.insert(descriptors->values.end(), row.begin(), row.end());
        }
        return descriptors;
    }

    /// What a camera sees of a part, with noise.
    ExtractedPhoto photo_of(std::uint32_t part, const Rigid3& cam_from_world,
                            const Camera& camera) const {
        synthetic::Rng rng(9);
        ExtractedPhoto photo;
        photo.metadata.width = camera.width;
        photo.metadata.height = camera.height;
        photo.metadata.content_hash = 77;
        for (std::uint32_t p = 0; p < kPoints; ++p) {
            const auto pixel = project(camera, cam_from_world * points_[part * kPoints + p]);
            Keypoint keypoint;
            keypoint.x = static_cast<float>(pixel->x() + 0.5 * rng.normal());
            keypoint.y = static_cast<float>(pixel->y() + 0.5 * rng.normal());
            photo.keypoints.push_back(keypoint);
            const auto& row = descriptors_[part * kPoints + p];
            photo.descriptors.values.insert(photo.descriptors.values.end(), row.begin(), row.end());
        }
        return photo;
    }

    Result<LocalisedPhoto> localise(const ExtractedPhoto& photo, const Camera& camera,
                                    bool refine = false) const {
        return localise_photo(
            *map_, photo, camera, refine,
            [&](ImageId image) {
                return Result<std::shared_ptr<const Descriptors>>(descriptors_of(image));
            },
            {});
    }

    std::vector<Eigen::Vector3d> points_;
    std::vector<std::vector<std::uint8_t>> descriptors_;
    std::unique_ptr<LocalisationMap> map_;
};

TEST_F(LocalisePhotoTest, FindsTheRightPartAndPose) {
    for (std::uint32_t part = 0; part < 2; ++part) {
        const Rigid3 truth = pose(part, 0.55);
        const auto found = localise(photo_of(part, truth, kCamera), kCamera);
        ASSERT_TRUE(found) << found.error().message;
        EXPECT_EQ(found->part, part);
        const double off =
            (found->cam_from_world.target_origin_in_source() - truth.target_origin_in_source())
                .norm();
        EXPECT_LT(off, 0.02);
        EXPECT_GT(found->inliers, 150U);
        EXPECT_LT(found->median_error_px, 1.0);
        ASSERT_TRUE(found->covariance);
        const double sigma = std::sqrt(found->covariance->bottomRightCorner<3, 3>().trace());
        EXPECT_LT(off, 5 * sigma);
        EXPECT_LT(sigma, 0.05);
        ASSERT_FALSE(found->images.empty());
        EXPECT_EQ(index_of(found->images.front().image) / kImages, part);
    }
}

TEST_F(LocalisePhotoTest, AFocalLengthThatIsAGuessIsEstimated) {
    const Rigid3 truth = pose(0, -0.2);
    Camera guess = make_camera(1000, 800, 1200.0, FocalSource::kUnknown);
    const auto found = localise(photo_of(0, truth, kCamera), guess, true);
    ASSERT_TRUE(found) << found.error().message;
    EXPECT_NEAR(found->camera.fx(), 900.0, 30.0);
}

TEST_F(LocalisePhotoTest, APhotographOfAnotherPlaceIsToldWhy) {
    ExtractedPhoto photo = photo_of(0, pose(0, 0.0), kCamera);
    synthetic::Rng rng(31);
    photo.descriptors.values.clear();
    for (std::uint32_t p = 0; p < kPoints; ++p) {
        const auto row = random_row(rng);
        photo.descriptors.values.insert(photo.descriptors.values.end(), row.begin(), row.end());
    }
    const auto found = localise(photo, kCamera);
    ASSERT_FALSE(found);
    EXPECT_NE(found.error().message.find("matches no image"), std::string::npos)
        << found.error().message;
    const auto empty = localise(ExtractedPhoto{}, kCamera);
    ASSERT_FALSE(empty);
    EXPECT_NE(empty.error().message.find("no feature"), std::string::npos);
}

}  // namespace
}  // namespace psfm
