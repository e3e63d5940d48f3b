// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/serve/replay.h"

#include <gtest/gtest.h>

#include <cstring>

namespace psfm {
namespace {

/// As tools/viewer/src/source.ts reads them: the poses after each version.
class DecodedReplay {
  public:
    explicit DecodedReplay(std::string bytes) : bytes_(std::move(bytes)) {
        float cube[4];
        for (float& part : cube) part = f32();
        std::map<std::uint32_t, ReplayPose> poses;
        for (std::uint32_t n = fixed(4); n > 0; --n) {
            images.push_back(leb());
            for (std::uint32_t k = leb(); k > 0; --k) {
                ReplayPose& pose = poses[leb()];
                for (int axis = 0; axis < 3; ++axis)
                    pose.centre[axis] =
                        cube[axis] + static_cast<float>(fixed(2)) * cube[3] / 65535.F;
                for (int part = 0; part < 4; ++part)
                    pose.cam_from_world.coeffs()[part] =
                        static_cast<float>(static_cast<std::int16_t>(fixed(2))) / 32767.F;
            }
            for (std::uint32_t k = leb(); k > 0; --k) poses.erase(leb());
            versions.push_back(poses);
        }
        EXPECT_EQ(at_, bytes_.size());
    }
    std::vector<std::uint32_t> images;
    std::vector<std::map<std::uint32_t, ReplayPose>> versions;

  private:
    std::uint32_t fixed(unsigned bytes) {
        std::uint32_t value = 0;
        for (unsigned i = 0; i < bytes; ++i)
            value |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes_.at(at_++)))
                     << (8 * i);
        return value;
    }
    float f32() {
        const std::uint32_t bits = fixed(4);
        float value = 0.F;
        std::memcpy(&value, &bits, sizeof value);
        return value;
    }
    std::uint32_t leb() {
        std::uint32_t value = 0;
        for (unsigned shift = 0;; shift += 7) {
            const std::uint32_t byte = fixed(1);
            value |= (byte & 0x7fU) << shift;
            if (byte < 0x80U) return value;
        }
    }
    std::string bytes_;
    std::size_t at_ = 0;
};

/// Cameras on an arc that look at its middle.
std::shared_ptr<SceneCluster> arc(std::uint32_t id, std::uint32_t first, std::uint32_t count,
                                  const Sim3& world_from_cluster, double step_rad = 0.2) {
    Reconstruction model;
    for (std::uint32_t i = first; i < first + count; ++i) {
        RegisteredImage image{ImageId{i}, CameraId{0}, {}};
        image.cam_from_cluster.rotation = Eigen::AngleAxisd(step_rad * i, Eigen::Vector3d::UnitY());
        image.cam_from_cluster.translation = {0.0, 0.1 * i, 4.0};
        model.images.push_back(image);
    }
    auto cluster = std::make_shared<SceneCluster>();
    cluster->id = ClusterId{id};
    cluster->model = std::make_shared<const Reconstruction>(model);
    cluster->world_from_cluster = world_from_cluster;
    return cluster;
}

Scene scene_of(std::uint32_t images, std::vector<std::shared_ptr<SceneCluster>> clusters) {
    Scene scene;
    scene.image_count = images;
    for (auto& cluster : clusters) scene.clusters.push_back(std::move(cluster));
    return scene;
}

Sim3 somewhere() {
    Sim3 place;
    place.scale = 3.0;
    place.rotation = Eigen::AngleAxisd(1.2, Eigen::Vector3d(1.0, -2.0, 0.5).normalized());
    place.translation = {10.0, -20.0, 5.0};
    return place;
}

/// Largest distance of places, and of directions [rad].
std::pair<double, double> off(const std::map<std::uint32_t, ReplayPose>& shown,
                              const Scene& scene) {
    std::size_t seen = 0;
    std::pair<double, double> worst;
    for (const auto& cluster : scene.clusters) {
        for (const RegisteredImage& image : cluster->model->images) {
            const auto found = shown.find(index_of(image.image));
            if (found == shown.end()) continue;
            ++seen;
            const Rigid3 pose = transform_pose(image.cam_from_cluster, cluster->world_from_cluster);
            worst.first = std::max(
                worst.first,
                (found->second.centre.cast<double>() - pose.target_origin_in_source()).norm());
            EXPECT_NEAR(found->second.cam_from_world.norm(), 1.F, 1e-3F);
            worst.second = std::max(worst.second,
                                    pose.rotation.angularDistance(
                                        found->second.cam_from_world.normalized().cast<double>()));
        }
    }
    EXPECT_EQ(seen, shown.size());
    return worst;
}

TEST(Replay, ItsLastVersionIsTodays) {
    // Two parts that are joined, and cameras that move, some of them by less than is told.
    const Scene today = scene_of(12, {arc(0, 0, 12, somewhere(), 0.2)});
    ReplayWriter writer(today, ReplayOptions{}.tolerance);
    writer.add(scene_of(5, {arc(0, 0, 5, {}, 0.21)}));
    writer.add(scene_of(10, {arc(0, 0, 5, {}, 0.2002), arc(1, 5, 5, somewhere(), 0.19)}));
    const DecodedReplay replay(writer.finish());
    EXPECT_EQ(replay.images, (std::vector<std::uint32_t>{5, 10, 12}));
    EXPECT_EQ(replay.versions.front().size(), 5U);
    EXPECT_EQ(replay.versions.back().size(), 12U);
    const auto [place, turn] = off(replay.versions.back(), today);
    EXPECT_LT(place, 1e-3);
    EXPECT_LT(turn, 1e-3);
}

TEST(Replay, AModelThatWasTheSameElsewhereLiesOverTodays) {
    const Scene today = scene_of(12, {arc(0, 0, 12, somewhere())});
    ReplayWriter writer(today, ReplayOptions{}.tolerance);
    writer.add(scene_of(6, {arc(0, 0, 4, {}), arc(1, 4, 2, {})}));
    const DecodedReplay replay(writer.finish());
    const auto [place, turn] = off(replay.versions.front(), today);
    EXPECT_LT(place, 0.01);
    EXPECT_LT(turn, 1e-3);
}

TEST(Replay, WhatLosesItsPlaceIsGone) {
    const Scene today = scene_of(8, {arc(0, 0, 4, {})});
    ReplayWriter writer(today, ReplayOptions{}.tolerance);
    writer.add(scene_of(6, {arc(0, 0, 6, {})}));
    const DecodedReplay replay(writer.finish());
    EXPECT_EQ(replay.versions.front().size(), 6U);
    EXPECT_EQ(replay.versions.back().size(), 4U);
}

}  // namespace
}  // namespace psfm
