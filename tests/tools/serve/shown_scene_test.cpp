// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/serve/shown_scene.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/tools/serve/decoded_model.h"

namespace psfm {
namespace {

using testing::DecodedModel;

/// Points in a unit cube that images 0 … n-1 see, two or more each.
Reconstruction model_of(std::vector<std::uint32_t> images, std::size_t points, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> place(0.0, 1.0);
    Reconstruction model;
    model.cameras[CameraId{0}] = make_camera(1000, 800, 900.0, FocalSource::kGiven);
    for (const std::uint32_t image : images) {
        RegisteredImage placed{ImageId{image}, CameraId{0}, {}};
        placed.cam_from_cluster.translation = Eigen::Vector3d(place(random), place(random), 3.0);
        model.images.push_back(placed);
    }
    std::vector<ScenePoint> list;
    for (std::size_t i = 0; i < points; ++i) {
        ScenePoint point;
        point.position = {place(random), place(random), place(random)};
        const std::size_t first = i % (images.size() - 1);
        point.track = {{ImageId{images[first]}, static_cast<std::uint32_t>(i)},
                       {ImageId{images[first + 1]}, static_cast<std::uint32_t>(i)}};
        list.push_back(std::move(point));
    }
    model.points = ScenePoints(std::move(list));
    return model;
}

Reconstruction moved_by(const Reconstruction& model, const Sim3& similarity) {
    Reconstruction moved = model;
    std::vector<ScenePoint> points = model.points.to_vector();
    for (ScenePoint& point : points) point.position = similarity * point.position;
    moved.points = ScenePoints(std::move(points));
    for (RegisteredImage& image : moved.images)
        image.cam_from_cluster = transform_pose(image.cam_from_cluster, similarity);
    return moved;
}

struct Stage {
    ShownScene shown;
    DecodedModel watcher;
    std::uint32_t revision = 0;
    std::size_t last_bytes = 0;

    void show(const std::map<std::uint32_t, Reconstruction>& models, bool settled = false,
              const std::map<std::uint32_t, Sim3>& places = {}) {
        Scene scene;
        scene.version = ++revision;
        for (const auto& [id, model] : models) {
            auto cluster = std::make_shared<SceneCluster>();
            cluster->id = ClusterId{id};
            cluster->revision = revision;
            cluster->model = std::make_shared<const Reconstruction>(model);
            for (const RegisteredImage& image : model.images)
                cluster->members.push_back(image.image);
            if (places.contains(id)) cluster->world_from_cluster = places.at(id);
            scene.clusters.push_back(std::move(cluster));
        }
        const std::string change = shown.update(scene, {}, settled);
        last_bytes = change.size();
        watcher.apply(change);
    }

    /// Largest distance between where a watcher sees a point and where the model has it.
    double worst(std::uint32_t id, const Reconstruction& model, const Sim3& place = {}) const {
        double worst = 0.0;
        std::size_t seen = 0;
        for (const ScenePoint& point : model.points) {
            const auto slot = shown.slot_of(ClusterId{id}, point.track.front());
            EXPECT_TRUE(slot.has_value());
            if (!slot) continue;
            const auto shown_at = watcher.world(id, *slot);
            EXPECT_TRUE(shown_at.has_value());
            if (!shown_at) continue;
            ++seen;
            worst = std::max(worst, (*shown_at - place * point.position).norm());
        }
        EXPECT_EQ(seen, watcher.clusters.at(id).points.size());
        return worst;
    }
};

TEST(ShownScene, AWatcherSeesTheModel) {
    Stage stage;
    const Reconstruction model = model_of({0, 1, 2, 3}, 500, 1);
    Sim3 place;
    place.scale = 2.0;
    place.translation = {5.0, 6.0, 7.0};
    stage.show({{7, model}}, false, {{7, place}});
    EXPECT_EQ(stage.watcher.point_count(), 500U);
    EXPECT_LT(stage.worst(7, model, place), 1e-4);
    EXPECT_EQ(stage.watcher.clusters.at(7).cameras.size(), 4U);
    EXPECT_EQ(stage.watcher.clusters.at(7).points.begin()->second.born, 2U);
}

TEST(ShownScene, AModelThatOnlyTurnsIsToldInAFewBytes) {
    Stage stage;
    const Reconstruction model = model_of({0, 1, 2, 3}, 2000, 2);
    stage.show({{1, model}});
    Sim3 turn;
    turn.scale = 3.0;
    turn.rotation = Eigen::AngleAxisd(1.0, Eigen::Vector3d(1.0, 2.0, 3.0).normalized());
    turn.translation = {10.0, -20.0, 30.0};
    const Reconstruction turned = moved_by(model, turn);
    stage.show({{1, turned}});
    EXPECT_LT(stage.last_bytes, 100U);
    EXPECT_EQ(stage.watcher.points_moved, 0U);
    EXPECT_LT(stage.worst(1, turned), 3e-3);
}

TEST(ShownScene, WhatMovesByItselfIsToldWhenItIsSeen) {
    Stage stage;
    const Reconstruction model = model_of({0, 1, 2, 3}, 1000, 3);
    stage.show({{1, model}});
    std::vector<ScenePoint> points = model.points.to_vector();
    for (std::size_t i = 0; i < 100; ++i) points[i].position.x() += i < 50 ? 0.1 : 0.002;
    Reconstruction bent = model;
    bent.points = ScenePoints(points);
    stage.show({{1, bent}});
    EXPECT_EQ(stage.watcher.points_moved, 50U);
    EXPECT_LT(stage.worst(1, bent), 0.005 * 3.0);
    stage.show({{1, bent}}, true);
    EXPECT_EQ(stage.watcher.points_moved, 100U);
    EXPECT_LT(stage.worst(1, bent), 0.0005 * 3.0);
}

TEST(ShownScene, PointsComeAndGo) {
    Stage stage;
    stage.show({{1, model_of({0, 1, 2, 3}, 300, 4)}});
    Reconstruction model = model_of({0, 1, 2, 3, 4}, 400, 4);
    stage.show({{1, model}});
    EXPECT_LT(stage.worst(1, model), 0.02);
    EXPECT_EQ(stage.watcher.clusters.at(1).cameras.size(), 5U);
    model.images.pop_back();
    std::vector<ScenePoint> points = model.points.to_vector();
    std::erase_if(points,
                  [](const ScenePoint& point) { return point.track[1].image == ImageId{4}; });
    model.points = ScenePoints(points);
    stage.show({{1, model}});
    EXPECT_EQ(stage.watcher.clusters.at(1).cameras.size(), 4U);
    EXPECT_EQ(stage.watcher.point_count(), points.size());
}

TEST(ShownScene, ClustersThatJoinHandTheirPointsOver) {
    Stage stage;
    const Reconstruction a = model_of({0, 1, 2, 3}, 800, 5);
    const Reconstruction b = model_of({4, 5, 6, 7}, 800, 6);
    stage.show({{1, a}, {2, b}});
    const std::size_t put = stage.watcher.points_put;
    Sim3 beside;
    beside.scale = 0.5;
    beside.translation = {2.0, 0.0, 0.0};
    const Reconstruction moved = moved_by(b, beside);
    Reconstruction joined = a;
    joined.images.insert(joined.images.end(), moved.images.begin(), moved.images.end());
    joined.points.append(moved.points);
    stage.show({{1, joined}});
    EXPECT_EQ(stage.watcher.points_put, put);
    EXPECT_EQ(stage.watcher.clusters.size(), 1U);
    EXPECT_EQ(stage.watcher.clusters.at(1).cameras.size(), 8U);
    EXPECT_LT(stage.worst(1, joined), 0.02);
    EXPECT_LT(stage.last_bytes, 4000U);

    stage.show({{1, a}, {3, b}});  // and come apart again
    EXPECT_EQ(stage.watcher.points_put, put);
    EXPECT_LT(stage.worst(3, b), 0.02);
    EXPECT_LT(stage.worst(1, a), 0.02);
}

TEST(ShownScene, ASnapshotIsWhatAllChangesTogetherAre) {
    Stage stage;
    for (unsigned round = 0; round < 8; ++round) {
        stage.show({{1, model_of({0, 1, 2, 3 + round}, 200 + 30 * round, round)},
                    {2, model_of({20, 21 + round, 40}, 100, round / 2)}});
        DecodedModel newcomer;
        newcomer.apply(stage.shown.snapshot());
        EXPECT_EQ(newcomer.number, stage.watcher.number);
        ASSERT_EQ(newcomer.clusters.size(), stage.watcher.clusters.size());
        for (const auto& [id, cluster] : stage.watcher.clusters) {
            const auto& other = newcomer.clusters.at(id);
            EXPECT_EQ(other.cameras.size(), cluster.cameras.size());
            ASSERT_EQ(other.points.size(), cluster.points.size());
            for (const auto& [slot, point] : cluster.points) {
                ASSERT_TRUE(other.points.contains(slot));
                const auto here = stage.watcher.world(id, slot);
                const auto there = newcomer.world(id, slot);
                ASSERT_TRUE(here && there);
                EXPECT_LT((*there - *here).norm(), 1e-3);
            }
        }
    }
}

TEST(ShownScene, ARestingClusterKeepsItsPoints) {
    Stage stage;
    const Reconstruction model = model_of({0, 1, 2, 3}, 100, 8);
    stage.show({{1, model}});
    Scene scene;
    scene.version = 2;
    auto cluster = std::make_shared<SceneCluster>();
    cluster->id = ClusterId{1};
    cluster->revision = stage.revision;
    Reconstruction poses = model;
    poses.points = {};
    cluster->model = std::make_shared<const Reconstruction>(poses);
    scene.clusters.push_back(cluster);
    stage.watcher.apply(stage.shown.update(scene, {}, false));
    EXPECT_EQ(stage.watcher.point_count(), 100U);
}

TEST(ShownScene, AModelThatKeepsMostOfItsPointsIsFollowedByWhatDiffers) {
    Stage stage;
    Reconstruction model = model_of({0, 1, 2, 3}, 5000, 9);
    stage.show({{1, model}});
    // Every fifth of the first thousand goes, the first of what stays moves, two more come.
    std::vector<std::uint8_t> removed(5000, 0);
    for (std::size_t i = 0; i < 1000; i += 5) removed[i] = 1;
    removed[1] = 1;
    ScenePoint moved = model.points[1];
    moved.position.x() += 0.5;
    std::vector<ScenePoint> more{moved};
    for (std::uint32_t k = 0; k < 2; ++k) {
        ScenePoint point;
        point.position = {0.5, 0.25 * k, 0.5};
        point.track = {{ImageId{0}, 6000 + k}, {ImageId{1}, 6000 + k}};
        more.push_back(point);
    }
    model.points = model.points.without(removed);
    model.points.append(ScenePoints(std::move(more)));
    stage.show({{1, model}});
    EXPECT_EQ(stage.watcher.point_count(), 4802U);
    EXPECT_EQ(stage.watcher.points_moved, 1U);
    EXPECT_LT(stage.worst(1, model), 3e-3);
    stage.show({{1, model}}, true);
    EXPECT_EQ(stage.watcher.point_count(), 4802U);
    EXPECT_LT(stage.worst(1, model), 3e-4);
}

}  // namespace
}  // namespace psfm
