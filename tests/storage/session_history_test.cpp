// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "tests/storage/random_values.h"
#include "tests/storage/test_session.h"

namespace psfm {
namespace {

using testing::TemporaryFolder;

constexpr std::uint32_t kImages = 9;

std::unique_ptr<SessionStore> open(const TemporaryFolder& folder, History history) {
    StoreOptions options;
    options.history = history;
    auto store = SessionStore::open(folder.session(), options);
    EXPECT_TRUE(store.ok()) << (store ? "" : store.error().message);
    return std::move(*store);
}

void commit(SessionStore& store, std::uint32_t from, std::uint32_t to) {
    for (std::uint32_t image = from; image < to; ++image) {
        ASSERT_TRUE(testing::commit_all(store, image));
    }
}

enum class Kept { kNothing, kPoses, kPoints };

/// What is there of the version after `image`; the test fails when it is not as committed.
Kept kept_of(const SessionReader& store, std::uint32_t image) {
    const auto scene = store.scene_after(image + 1);
    if (!scene || scene->version != image + 1) return Kept::kNothing;
    EXPECT_EQ(scene->image_count, image + 1);
    const StoredSolution expected = testing::expected_solution(image);
    const Reconstruction& model = *scene->clusters.front()->model;
    EXPECT_TRUE(testing::same_poses(model, *expected.model));
    if (model.points.empty()) return Kept::kPoses;
    EXPECT_TRUE(testing::same_points(model, *expected.model));
    return Kept::kPoints;
}

std::uint64_t count_of(const SessionReader& store, const std::string& kind) {
    const auto report = store.check({});
    EXPECT_TRUE(report.ok() && report->damaged.empty());
    for (const auto& [name, count] : report->records) {
        if (name == kind) return count;
    }
    return 0;
}

TEST(SessionHistory, KeepsPosesOfEveryVersionByDefault) {
    EXPECT_EQ(StoreOptions{}.history, History::kPoses);
    const TemporaryFolder folder;
    const auto store = open(folder, History::kPoses);
    commit(*store, 0, kImages);
    for (std::uint32_t image = testing::kFirstSolved; image + 1 < kImages; ++image) {
        EXPECT_EQ(kept_of(*store, image), Kept::kPoses) << image;
    }
    EXPECT_EQ(kept_of(*store, kImages - 1), Kept::kPoints);
    EXPECT_EQ(count_of(*store, "points"), 1U);
    EXPECT_EQ(count_of(*store, "solution"), kImages + 1 - testing::kFirstSolved);
    EXPECT_EQ(testing::difference(*store), "");
}

TEST(SessionHistory, KeepsPointsOfEveryVersionWhenFull) {
    const TemporaryFolder folder;
    const auto store = open(folder, History::kFull);
    commit(*store, 0, kImages);
    for (std::uint32_t image = testing::kFirstSolved; image < kImages; ++image) {
        EXPECT_EQ(kept_of(*store, image), Kept::kPoints) << image;
    }
}

TEST(SessionHistory, KeepsTheLatestVersionOnlyWhenNone) {
    const TemporaryFolder folder;
    const auto store = open(folder, History::kNone);
    commit(*store, 0, kImages);
    EXPECT_EQ(count_of(*store, "scene version"), 1U);
    EXPECT_EQ(count_of(*store, "solution"), 1U);
    EXPECT_EQ(kept_of(*store, kImages - 1), Kept::kPoints);
    EXPECT_EQ(store->scene_after(kImages - 1).error().code, ErrorCode::kNotFound);
    EXPECT_EQ(testing::difference(*store), "");
}

TEST(SessionHistory, FindsTheLastVersionWithAtMostSoManyImages) {
    const TemporaryFolder folder;
    const auto store = open(folder, History::kPoses);
    commit(*store, 0, 5);
    // A second version with the same images, as a later solve publishes it.
    StoredSceneVersion again = testing::expected_scene(4);
    again.version = 6;
    ASSERT_TRUE(store->commit_scene(again, {}).ok());
    EXPECT_EQ(store->scene_after(4)->version, 4U);
    EXPECT_EQ(store->scene_after(5)->version, 6U);
    EXPECT_EQ(store->scene_after(1000)->version, 6U);
    EXPECT_EQ(store->scene_after(0).error().code, ErrorCode::kNotFound);
}

TEST(SessionHistory, KeepsThePointsOfTheSceneWhileNewerSolutionsWait) {
    for (const History history : {History::kNone, History::kPoses, History::kFull}) {
        const TemporaryFolder folder;
        {
            const auto store = open(folder, history);
            commit(*store, 0, 5);
            ASSERT_TRUE(store
                            ->commit_image(testing::expected_image(5), testing::expected_camera(),
                                           testing::expected_keypoints(5),
                                           testing::expected_descriptors(5))
                            .ok());
            ASSERT_TRUE(store
                            ->commit_pairs(ImageId{5}, testing::expected_pairs(5),
                                           {testing::expected_cluster(5, false)}, {})
                            .ok());
            ASSERT_TRUE(store
                            ->commit_solution(testing::expected_solution(5),
                                              testing::expected_cluster(5, true), {})
                            .ok());
            EXPECT_EQ(kept_of(*store, 4), Kept::kPoints);
        }
        // The mark outlives the process: after reopening, the next version still tidies up.
        const auto store = open(folder, history);
        EXPECT_EQ(kept_of(*store, 4), Kept::kPoints);
        EXPECT_EQ((*store->solution(ClusterId{0}))->revision,
                  testing::expected_solution(5).revision);
        ASSERT_TRUE(store->commit_scene(testing::expected_scene(5), {}).ok());
        EXPECT_EQ(kept_of(*store, 5), Kept::kPoints);
        EXPECT_EQ(count_of(*store, "points"), history == History::kFull ? 4U : 1U);
    }
}

TEST(SessionHistory, MayChangeFromOneOpeningToTheNext) {
    const TemporaryFolder folder;
    commit(*open(folder, History::kFull), 0, 5);
    commit(*open(folder, History::kPoses), 5, 7);
    {
        const auto store = open(folder, History::kPoses);
        commit(*store, 7, kImages);
        EXPECT_EQ(kept_of(*store, 3), Kept::kPoints);
        EXPECT_EQ(kept_of(*store, 4), Kept::kPoints);
        EXPECT_EQ(kept_of(*store, 5), Kept::kPoses);
        EXPECT_EQ(kept_of(*store, 7), Kept::kPoses);
        EXPECT_EQ(count_of(*store, "points"), 4U);
    }
    {
        const auto store = open(folder, History::kNone);
        EXPECT_EQ(count_of(*store, "scene version"), 1U);
        EXPECT_EQ(count_of(*store, "solution"), 1U);
        EXPECT_EQ(count_of(*store, "points"), 1U);
        EXPECT_EQ(testing::difference(*store), "");
        commit(*store, kImages, kImages + 1);
    }
    const auto store = open(folder, History::kPoses);
    commit(*store, kImages + 1, kImages + 3);
    EXPECT_EQ(kept_of(*store, kImages + 1), Kept::kPoses);
    EXPECT_EQ(kept_of(*store, kImages + 2), Kept::kPoints);
    EXPECT_EQ(count_of(*store, "points"), 1U);
}

TEST(SessionHistory, KeepsRemovedClustersWhileTheirImagesAreUnsolved) {
    const TemporaryFolder folder;
    const auto store = open(folder, History::kPoses);
    commit(*store, 0, 5);
    const auto images = testing::first_images(6);
    ASSERT_TRUE(store
                    ->commit_image(testing::expected_image(5), testing::expected_camera(),
                                   testing::expected_keypoints(5), {})
                    .ok());
    ASSERT_TRUE(store
                    ->commit_pairs(ImageId{5}, {}, {{ClusterId{1}, images, 1, 0, 0, 0, {}, {}}},
                                   {ClusterId{0}})
                    .ok());
    // The version shows the successor, which is not solved yet: the old model is its material.
    StoredSceneVersion scene;
    scene.version = 6;
    scene.image_count = 6;
    scene.placements = {{ClusterId{1}, 0, images, {}, 0}};
    ASSERT_TRUE(store->commit_scene(scene, {}).ok());
    ASSERT_TRUE(store->solution(ClusterId{0})->has_value());
    EXPECT_FALSE((*store->solution(ClusterId{0}))->model->points.empty());

    ASSERT_TRUE(testing::solve_successor(*store, images, scene));
    EXPECT_FALSE(store->solution(ClusterId{0})->has_value());
    EXPECT_EQ(count_of(*store, "points"), 1U);
    // Its poses stay: earlier versions show them.
    EXPECT_EQ(kept_of(*store, 4), Kept::kPoses);
}

/// @param history  from when on the model waits to be joined
void expect_to_stay_until_it_is_joined(History history) {
    const TemporaryFolder folder;
    const auto store = open(folder, History::kPoses);
    commit(*store, 0, 5);
    const StoredCluster before = store->clusters()->front();
    const SolutionReference source{before.id, before.revision};
    ASSERT_TRUE(store
                    ->commit_image(testing::expected_image(5), testing::expected_camera(),
                                   testing::expected_keypoints(5), {})
                    .ok());
    // Images 2 … 4 leave for a new cluster and bring their part of the model.
    StoredCluster rest = before;
    rest.members = {ImageId{0}, ImageId{1}};
    rest.topology += 1;
    const std::vector<ImageId> moved{ImageId{2}, ImageId{3}, ImageId{4}, ImageId{5}};
    StoredCluster other{ClusterId{1}, moved, 1, 0, 0, 1, {source}, {}};
    ASSERT_TRUE(store->commit_pairs(ImageId{5}, {}, {rest, other}, {}).ok());

    testing::Rng rng(4);
    const auto solve = [&](StoredCluster& cluster) {
        cluster.solved_topology = cluster.topology;
        cluster.revision += 1;
        const auto model =
            std::make_shared<const Reconstruction>(testing::random_model(cluster.members, 5, rng));
        return store->commit_solution({cluster.id, cluster.revision, model, ""}, cluster, {}).ok();
    };
    StoredSceneVersion scene;
    scene.version = 100;
    scene.image_count = 6;
    ASSERT_TRUE(solve(rest));
    scene.placements = {{rest.id, rest.revision, rest.members, {}, 0}};
    ASSERT_TRUE(store->commit_scene(scene, {}).ok());
    ASSERT_TRUE(store->keep_history(history).ok());
    const auto kept = store->recycled_model(source);
    ASSERT_TRUE(kept.ok() && *kept) << "the new cluster is not solved yet";
    EXPECT_FALSE((*kept)->points.empty());

    ASSERT_TRUE(solve(other));
    scene.version = 101;
    scene.placements.push_back({other.id, other.revision, other.members, {}, 0});
    ASSERT_TRUE(store->commit_scene(scene, {}).ok());
    const auto gone = store->recycled_model(source);
    ASSERT_TRUE(gone.ok()) << gone.error().message;
    EXPECT_EQ(*gone, nullptr);
    EXPECT_EQ(count_of(*store, "points"), 2U);
}

TEST(SessionHistory, AModelThatAnotherClusterIsToJoinStaysUntilItHas) {
    expect_to_stay_until_it_is_joined(History::kPoses);
    expect_to_stay_until_it_is_joined(History::kNone);
}

}  // namespace
}  // namespace psfm
