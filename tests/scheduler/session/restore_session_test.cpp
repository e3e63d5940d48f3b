// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "scheduler/session/encode_state.h"
#include "scheduler/session/session_state.h"
#include "tests/scheduler/flow/serial_session.h"
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

}  // namespace
}  // namespace psfm
