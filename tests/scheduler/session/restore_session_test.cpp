// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "scheduler/session/encode_state.h"
#include "scheduler/session/session_state.h"
#include "storage/records/image_records.h"
#include "storage/records/pair_records.h"
#include "storage/records/record_envelope.h"
#include "storage/records/scene_records.h"
#include "tests/scheduler/flow/serial_session.h"
#include "tests/storage/raw_database.h"
#include "tests/storage/test_session.h"

namespace psfm {
namespace {

constexpr std::uint32_t kImages = 4;
constexpr ClusterId kCluster{0};

/// A session whose only cluster is solved, with this text as what its next solve recycles.
/// @param change  of the cluster as stored
/// @param is_shown  by the last version, which else shows its solution before
Result<RestoredSession> restored_with(const std::string& state_json,
                                      const std::function<void(StoredCluster&)>& change = {},
                                      bool is_shown = false) {
    const testing::TemporaryFolder folder;
    const auto store = test::open_store(folder);
    EXPECT_TRUE(testing::finish(*store, kImages));
    StoredSolution solution = testing::expected_solution(kImages - 1);
    ++solution.revision;
    solution.state_json = state_json;
    StoredCluster cluster = testing::expected_cluster(kImages - 1, true);
    cluster.revision = solution.revision;
    if (change) change(cluster);
    EXPECT_TRUE(store->commit_solution(solution, cluster, {}).ok());
    StoredSceneVersion scene = testing::expected_scene(kImages - 1);
    ++scene.version;
    scene.summary_json = encode_summary({});
    if (is_shown) scene.placements.front().revision = solution.revision;
    EXPECT_TRUE(store->commit_scene(scene, {}).ok());
    SessionConfig config;
    StageOptions options = *stage_options(config);
    options.solve.policy.mu_min = kImages;
    return restore_session(*store, config, options);
}

TEST(RestoreSession, TakesUpWhatTheLastSolveLeft) {
    const auto restored = restored_with(R"({"images_at_full_adjustment":3})");
    ASSERT_TRUE(restored.ok()) << restored.error().message;
    EXPECT_TRUE(restored->remarks.empty());
    const ClusterEntry& entry = restored->state.clusters.entries().at(kCluster);
    EXPECT_EQ(entry.material.state.images_at_full_adjustment, 3U);
}

TEST(RestoreSession, OpensWithAWordWhereThatIsDamaged) {
    const auto restored = restored_with(R"({"images_at_full_adjustment":"three"})");
    ASSERT_TRUE(restored.ok()) << restored.error().message;
    ASSERT_EQ(restored->remarks.size(), 1U);
    EXPECT_EQ(restored->remarks.front().find("cluster 0: "), 0U) << restored->remarks.front();
    const ClusterEntry& entry = restored->state.clusters.entries().at(kCluster);
    EXPECT_EQ(entry.material.state, SolveState{});
    EXPECT_FALSE(entry.material.models.empty()) << "the model is good without it";
}

TEST(RestoreSession, StartsNothingFromAModelThatWasAbandoned) {
    const auto kept = restored_with("{}");
    ASSERT_TRUE(kept.ok()) << kept.error().message;
    EXPECT_EQ(kept->state.clusters.entries().at(kCluster).material.models.size(), 1U);
    const auto restored =
        restored_with("{}", [](StoredCluster& cluster) { cluster.abandoned = true; });
    ASSERT_TRUE(restored.ok()) << restored.error().message;
    const ClusterEntry& entry = restored->state.clusters.entries().at(kCluster);
    EXPECT_EQ(entry.published.model, nullptr);
    EXPECT_TRUE(entry.material.models.empty());
    EXPECT_GT(entry.published.revision, 0U) << "none is used twice";
}

TEST(RestoreSession, GoesOnConcludingWhereThatWasNotAtItsEnd) {
    const auto at_rest = [](StoredCluster& cluster) { cluster.at_rest = true; };
    EXPECT_TRUE(restored_with("{}", at_rest)->state.concluding) << "solved, and not shown yet";
    EXPECT_FALSE(restored_with("{}", at_rest, true)->state.concluding);
    EXPECT_FALSE(restored_with("{}")->state.concluding);
    const auto dirty = [&](StoredCluster& cluster) {
        cluster.at_rest = true;
        ++cluster.topology;
    };
    EXPECT_TRUE(restored_with("{}", dirty, true)->state.concluding);
}

/// Sessions of sound records that do not fit each other: somebody made them for the purpose.
class MisfitSession : public ::testing::Test {
  protected:
    MisfitSession() {
        const auto store = test::open_store(folder_);
        EXPECT_TRUE(testing::finish(*store, kImages));
        StoredSceneVersion scene = testing::expected_scene(kImages - 1);
        ++scene.version;
        scene.summary_json = encode_summary({});
        EXPECT_TRUE(store->commit_scene(scene, {}).ok());
    }

    void put(Family family, RecordKind kind, const std::string& key,
             const Result<std::string>& payload) const {
        testing::RawDatabase(folder_.session()).put(family, key, seal_record(kind, key, *payload));
    }
    /// @param store  of the session
    static Result<RestoredSession> restore(const SessionStore& store) {
        const SessionConfig config;
        StageOptions options = *stage_options(config);
        options.solve.policy.mu_min = kImages;
        return restore_session(store, config, options);
    }
    void expect_damaged(const std::string& why) const {
        const auto store = test::open_store(folder_);
        const auto restored = restore(*store);
        ASSERT_FALSE(restored.ok());
        EXPECT_EQ(restored.error().code, ErrorCode::kDamaged);
        EXPECT_EQ(restored.error().message.find(why + "; 'psfm check'"), 0U)
            << restored.error().message;
    }

    testing::TemporaryFolder folder_;
};

TEST_F(MisfitSession, HasPairsOfAnImageThatIsMissing) {
    const ImageId missing{kImages};
    put(Family::kPairs, RecordKind::kPairs, encode_key(missing), encode_pairs(missing, {}));
    expect_damaged("image 4 has pairs, and is missing");
}

TEST_F(MisfitSession, LacksACamera) {
    testing::RawDatabase(folder_.session()).remove(Family::kMeta, camera_key(CameraId{0}));
    expect_damaged("image 0 has a camera that is missing");
}

TEST_F(MisfitSession, AdoptsAnImageWithoutPairs) {
    {
        const auto store = test::open_store(folder_);
        StoredCluster adopting = store->clusters()->front();
        adopting.adopted = {ImageId{77}};
        ASSERT_TRUE(store->commit_clusters({{adopting}, {}}).ok());
    }
    expect_damaged("cluster 0 has adopted an image that has no pairs");
}

TEST_F(MisfitSession, ShowsMoreImagesThanThereAre) {
    StoredSceneVersion scene;
    scene.version = 100;
    scene.image_count = kImages + 1;
    put(Family::kScenes, RecordKind::kScene, encode_key(SceneKey{scene.image_count, scene.version}),
        encode_scene({scene, {}}));
    expect_damaged("the latest version knows of more images than there are");
}

TEST_F(MisfitSession, NamesFeaturesThatAnImageLacks) {
    constexpr ImageId kPoor{2};
    put(Family::kKeypoints, RecordKind::kKeypoints, encode_key(kPoor),
        encode_keypoints(Keypoints(1)));
    const auto store = test::open_store(folder_);
    const auto restored = restore(*store);
    ASSERT_TRUE(restored.ok()) << "keypoints are not read before they are used: "
                               << restored.error().message;
    ResidentKeypoints keypoints = restored->state.photographs.keypoints;
    EXPECT_TRUE(keypoints.use(std::vector{ImageId{0}, ImageId{1}}, *store).ok());
    const auto used = keypoints.use(std::vector{kPoor}, *store);
    ASSERT_FALSE(used.ok());
    EXPECT_EQ(used.error().code, ErrorCode::kDamaged);
    EXPECT_EQ(used.error().message.find("image 2 lacks features"), 0U) << used.error().message;
}

}  // namespace
}  // namespace psfm
