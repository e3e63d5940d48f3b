// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/synthetic/look_alikes/look_alike_geometry.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace psfm::synthetic {
namespace {

double degrees_between(const Rigid3& a, const Rigid3& b) {
    return angle_between(a.rotation, b.rotation) * 180.0 / M_PI;
}

Rigid3 true_pose(const LookAlikeScene& scene, ImagePair pair) {
    return scene.scene.images[index_of(pair.second)].cam_from_world *
           inverse(scene.scene.images[index_of(pair.first)].cam_from_world);
}

std::optional<LookAlikePair> pair_of(const LookAlikeScene& scene, std::uint32_t a,
                                     std::uint32_t b) {
    for (LookAlikePair& pair : pairs_with_later(scene, index_looks(scene), ImageId{a}, {})) {
        if (pair.pair.second == ImageId{b}) return std::move(pair);
    }
    return std::nullopt;
}

/// The point of it all: robust verification finds look-alikes as good as neighbours, and the pose
/// of a temple that is folded.
TEST(VerifyLookAlike, TakesCopiesForTheSameThing) {
    const LookAlikeScene scene = make_temple({.images = 72}, 1);
    const auto cameras = exif_cameras(scene, 0.005);
    // 5 degrees a step: a side and one, two steps; the opposite side and one less.
    for (const std::uint32_t other : {13U, 14U, 35U}) {
        const auto pair = pair_of(scene, 0, other);
        ASSERT_TRUE(pair.has_value()) << other;
        EXPECT_TRUE(pair->folded);
        const auto verified = verify_look_alike(scene, *pair, cameras, {});
        ASSERT_TRUE(verified.ok()) << verified.error().message;
        const Rigid3& pose = verified->geometry.cam2_from_cam1;
        EXPECT_GT(degrees_between(pose, true_pose(scene, pair->pair)), 45.0);
        EXPECT_LT(degrees_between(pose, pair->cam2_from_cam1), 1.5);
        EXPECT_GT(pose.translation.dot(pair->cam2_from_cam1.translation.normalized()), 0.99);
        EXPECT_GT(static_cast<double>(verified->geometry.inliers.size()),
                  0.85 * static_cast<double>(pair->matches.size()));
    }
    const auto neighbours = pair_of(scene, 0, 1);
    ASSERT_TRUE(neighbours.has_value());
    const auto verified = verify_look_alike(scene, *neighbours, cameras, {});
    ASSERT_TRUE(verified.ok());
    EXPECT_LT(
        degrees_between(verified->geometry.cam2_from_cam1, true_pose(scene, neighbours->pair)),
        0.5);
}

TEST(ExplainPair, SaysWhatVerificationFinds) {
    const LookAlikeScene scene = make_streets({.images = 200, .copied_facades = 0.5}, 1);
    const LookAlikeIndex index = index_looks(scene);
    std::size_t compared = 0;
    std::size_t close = 0;  // flat facades and short baselines leave some poses vague
    std::size_t folded = 0;
    for (std::uint32_t i = 0; i < 200; i += 5) {
        for (const LookAlikePair& pair : pairs_with_later(scene, index, ImageId{i}, {})) {
            if (pair.agreeing < 60) continue;
            const VerifiedPair explained = explain_pair(scene, index, pair, 4.0);
            EXPECT_EQ(explained.pair, pair.pair);
            const auto verified = verify_look_alike(scene, pair, scene.scene.cameras, {});
            ASSERT_TRUE(verified.ok()) << verified.error().message;
            if (explained.geometry.kind != TwoViewKind::kEssential ||
                verified->geometry.kind != TwoViewKind::kEssential) {
                continue;
            }
            ++compared;
            folded += pair.folded ? 1 : 0;
            EXPECT_NEAR(explained.geometry.matrix.norm(), 1.0, 1e-9);
            EXPECT_NEAR(explained.geometry.cam2_from_cam1.translation.norm(), 1.0, 1e-9);
            const double angle = degrees_between(explained.geometry.cam2_from_cam1,
                                                 verified->geometry.cam2_from_cam1);
            EXPECT_LT(angle, 15.0);
            close += angle < 2.0 ? 1 : 0;
            EXPECT_NEAR(static_cast<double>(explained.geometry.inliers.size()),
                        static_cast<double>(verified->geometry.inliers.size()),
                        0.15 * static_cast<double>(pair.matches.size()));
            EXPECT_TRUE(std::ranges::includes(pair.matches, explained.geometry.inliers));
        }
    }
    EXPECT_GT(compared, 100U);
    EXPECT_GT(static_cast<double>(close), 0.85 * static_cast<double>(compared));
    EXPECT_GT(folded, 5U);
}

TEST(ExplainPair, WithoutParallaxIsATurn) {
    // Images 0 and 12 stand before equal sides, a few decimetres apart once folded.
    const LookAlikeScene scene = make_temple({.images = 72}, 1);
    const LookAlikeIndex index = index_looks(scene);
    std::size_t turns = 0;
    for (std::uint32_t i = 0; i < 60; ++i) {
        const auto pairs = pairs_with_later(scene, index, ImageId{i}, {});
        const auto pair =
            std::ranges::find(pairs, ImagePair{ImageId{i}, ImageId{i + 12}}, &LookAlikePair::pair);
        ASSERT_NE(pair, pairs.end());
        const TwoViewGeometry geometry = explain_pair(scene, index, *pair, 4.0).geometry;
        EXPECT_LT(degrees_between(geometry.cam2_from_cam1, pair->cam2_from_cam1), 1e-6);
        if (geometry.kind != TwoViewKind::kPureRotation) continue;
        ++turns;
        EXPECT_EQ(geometry.cam2_from_cam1.translation.norm(), 0.0);
        EXPECT_NEAR(geometry.matrix.norm(), 1.0, 1e-9);
        EXPECT_GE(geometry.inliers.size(), 15U);
    }
    EXPECT_GT(turns, 0U);
}

TEST(VerifiedLookAlikes, AreAllThatPass) {
    const LookAlikeScene scene = make_temple({.images = 12}, 1);
    const auto pairs = verified_look_alikes(scene, {}, exif_cameras(scene, 0.005), {});
    ASSERT_GT(pairs.size(), 40U) << "six sides of two images: nearly all of 66";
    EXPECT_TRUE(
        std::ranges::is_sorted(pairs, {}, [](const VerifiedPairPtr& pair) { return pair->pair; }));
}

TEST(ExifCameras, AreOffBySoMuch) {
    const LookAlikeScene scene = make_courtyard({.images = 9, .users = 3}, 1);
    for (const auto& [id, camera] : exif_cameras(scene, 0.01)) {
        const Camera& truth = scene.scene.cameras.at(id);
        EXPECT_EQ(camera.focal_source, FocalSource::kExif);
        EXPECT_NEAR(std::abs(camera.mean_focal() / truth.mean_focal() - 1.0), 0.01, 1e-12);
        EXPECT_NEAR(camera.fy() / camera.fx(), truth.fy() / truth.fx(), 1e-12);
        EXPECT_TRUE(validate(camera).ok());
    }
    EXPECT_NE(scene.scene.cameras.at(CameraId{1}).params[3], 0.0);
    EXPECT_EQ(exif_cameras(scene, 0.01).at(CameraId{1}).params[3], 0.0);
}

}  // namespace
}  // namespace psfm::synthetic
