// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/merge/geo/keep_frame.h"

#include <gtest/gtest.h>

#include <vector>

#include "stages/merge/values/merge_options.h"
#include "tests/stages/merge/cut_scene.h"

namespace psfm {
namespace {

struct Cameras {
    std::vector<PlacedImage> images;
    std::unordered_map<ImageId, Rigid3> published;
};

/// Cameras published somewhere, and now in a component's frame that a similarity leads away from.
Cameras cameras_at(const std::vector<Eigen::Vector3d>& centres, const Sim3& world_from_component,
                   synthetic::Rng& rng) {
    Cameras cameras;
    for (std::uint32_t k = 0; k < centres.size(); ++k) {
        Rigid3 cam_from_world{rng.rotation(), {}};
        cam_from_world.translation = -(cam_from_world.rotation * centres[k]);
        cameras.published[static_cast<ImageId>(k)] = cam_from_world;
        cameras.images.push_back({static_cast<ImageId>(k),
                                  transform_pose(cam_from_world, inverse(world_from_component))});
    }
    return cameras;
}

std::vector<Eigen::Vector3d> spread(std::size_t count, synthetic::Rng& rng) {
    std::vector<Eigen::Vector3d> centres;
    for (std::size_t k = 0; k < count; ++k) centres.push_back(5.0 * rng.normal3());
    return centres;
}

TEST(KeepFrame, FindsTheFormerFrame) {
    synthetic::Rng rng(1);
    const Sim3 truth = synthetic::random_gauge(1);
    const Cameras cameras = cameras_at(spread(30, rng), truth, rng);
    EXPECT_LT(test::difference(world_from_component(cameras.images, cameras.published, {}, {},
                                                    MergeOptions{}.max_stayed_move),
                               truth),
              1e-8);
}

TEST(KeepFrame, FollowsTheMajority) {
    synthetic::Rng rng(2);
    const Sim3 truth = synthetic::random_gauge(2);
    Cameras cameras = cameras_at(spread(30, rng), truth, rng);
    const Sim3 elsewhere = synthetic::random_gauge(3);
    for (std::uint32_t k = 0; k < 12; ++k) {
        Rigid3& pose = cameras.published[static_cast<ImageId>(k)];
        pose = transform_pose(pose, elsewhere);
    }
    const Sim3 found = world_from_component(cameras.images, cameras.published, {}, {},
                                            MergeOptions{}.max_stayed_move);
    EXPECT_LT(test::difference(found, truth), 1e-3);
}

TEST(KeepFrame, FollowsTheMajorityOfThousands) {
    // Of which not all are looked at; the first and the last ones moved elsewhere, so that a
    // thousand from either end would follow those.
    synthetic::Rng rng(8);
    const Sim3 truth = synthetic::random_gauge(8);
    constexpr std::uint32_t kImages = 3700;
    Cameras cameras = cameras_at(spread(kImages, rng), truth, rng);
    const Sim3 elsewhere = synthetic::random_gauge(9);
    for (std::uint32_t k = 0; k < kImages; ++k) {
        if (k >= 600 && k < kImages - 600) continue;
        Rigid3& pose = cameras.published[static_cast<ImageId>(k)];
        pose = transform_pose(pose, elsewhere);
    }
    const Sim3 found = world_from_component(cameras.images, cameras.published, {}, {},
                                            MergeOptions{}.max_stayed_move);
    EXPECT_LT(test::difference(found, truth), 1e-3);
}

TEST(KeepFrame, NeedsNoMoreThanALineOrTwoCameras) {
    synthetic::Rng rng(4);
    const Sim3 truth = synthetic::random_gauge(4);
    for (const std::vector<Eigen::Vector3d>& centres :
         {std::vector<Eigen::Vector3d>{{0, 0, 0}, {1, 2, 3}, {2, 4, 6}, {5, 10, 15}},
          std::vector<Eigen::Vector3d>{{0, 0, 0}, {1, 2, 3}}}) {
        const Cameras cameras = cameras_at(centres, truth, rng);
        const Sim3 found = world_from_component(cameras.images, cameras.published, {}, {},
                                                MergeOptions{}.max_stayed_move);
        EXPECT_LT(test::difference(found, truth), 1e-8) << centres.size();
    }
}

TEST(KeepFrame, OneCameraGivesPlaceAndDirection) {
    synthetic::Rng rng(5);
    const Sim3 truth = synthetic::random_gauge(5);
    const Cameras cameras = cameras_at(spread(1, rng), truth, rng);
    Sim3 fallback;
    fallback.scale = 3.0;
    const Sim3 found = world_from_component(cameras.images, cameras.published, {}, fallback,
                                            MergeOptions{}.max_stayed_move);
    EXPECT_EQ(found.scale, 3.0);
    const Rigid3 moved = transform_pose(cameras.images[0].cam_from_component, found);
    const Rigid3& before = cameras.published.at(ImageId{0});
    EXPECT_LT(angle_between(moved.rotation, before.rotation), 1e-9);
    EXPECT_LT((moved.target_origin_in_source() - before.target_origin_in_source()).norm(), 1e-9);
}

TEST(KeepFrame, WithoutHistoryTheFallbackStands) {
    synthetic::Rng rng(6);
    Cameras cameras = cameras_at(spread(5, rng), {}, rng);
    cameras.published.clear();
    const Sim3 fallback = synthetic::random_gauge(6);
    const Sim3 found = world_from_component(cameras.images, cameras.published, {}, fallback,
                                            MergeOptions{}.max_stayed_move);
    EXPECT_EQ(found.scale, fallback.scale);
    EXPECT_EQ(found.translation, fallback.translation);
}

TEST(KeepFrame, AnUnmovedCandidateStandsToTheBit) {
    synthetic::Rng rng(7);
    const Sim3 truth = synthetic::random_gauge(7);
    const Cameras cameras = cameras_at(spread(20, rng), truth, rng);
    const Sim3 found = world_from_component(cameras.images, cameras.published, std::vector{truth},
                                            {}, MergeOptions{}.max_stayed_move);
    EXPECT_EQ(found.translation, truth.translation);
    EXPECT_EQ(found.scale, truth.scale);
}

TEST(MedianNeighborDistance, OfARow) {
    const std::vector<Eigen::Vector3d> row{{0, 0, 0}, {1, 0, 0}, {3, 0, 0}, {6, 0, 0}, {8, 0, 0}};
    EXPECT_DOUBLE_EQ(median_neighbor_distance(row), 2.0);
    EXPECT_EQ(median_neighbor_distance({}), 0.0);
}

}  // namespace
}  // namespace psfm
