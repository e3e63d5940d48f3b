// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/session/resident_models.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "tests/scheduler/flow/serial_session.h"
#include "tests/scheduler/session/made_up_clusters.h"
#include "tests/storage/test_session.h"
#include "tests/synthetic/verified_pairs.h"

namespace psfm {
namespace {

using test::SerialSession;

/// A session whose only cluster is clean and merged.
class ResidentModelsTest : public ::testing::Test {
  protected:
    static constexpr std::uint32_t kImages = 4;
    static constexpr ClusterId kCluster{0};

    ResidentModelsTest() : store_(test::open_store(folder_)) {
        EXPECT_TRUE(testing::finish(*store_, kImages));
        const StoredSolution solution = testing::expected_solution(kImages - 1);
        ClusterEntry entry;
        entry.id = kCluster;
        entry.membership.members = store_->clusters()->front().members;
        entry.membership.topology = entry.published.topology = 1;
        entry.published.revision = solution.revision;
        entry.published.model = solution.model;
        entry.published.cameras = std::make_shared<const ModelCameras>();
        entry.material.models = {{kCluster, entry.published.revision, entry.published.model}};
        restore(entry);
        models_.set_budget(0);
        EXPECT_TRUE(use().ok());
    }
    void restore(const ClusterEntry& entry) {
        table_ = ClusterTable(2, {entry}, test::hosts_of({entry}));
    }
    const ClusterEntry& entry() const { return table_.entries().at(kCluster); }
    Result<void> use() { return models_.use(std::span(&kCluster, 1), table_, *store_); }
    void let_uses_pass(std::uint64_t uses) {
        for (std::uint64_t i = 0; i < uses; ++i) EXPECT_TRUE(models_.use({}, table_, *store_).ok());
    }

    testing::TemporaryFolder folder_;
    std::unique_ptr<SessionStore> store_;
    ClusterTable table_{2};
    ResidentModels models_;
};

TEST_F(ResidentModelsTest, LeavesPointsToTheStoreAndReadsThemBack) {
    const auto model = entry().published.model;
    ASSERT_FALSE(model->points.empty());
    let_uses_pass(ResidentModels::kUsesKept);
    models_.release(table_);
    ASSERT_TRUE(entry().published.rests);
    EXPECT_TRUE(entry().published.model->points.empty());
    EXPECT_EQ(entry().material.models.front().model, entry().published.model);
    ASSERT_EQ(entry().published.model->images.size(), model->images.size());
    EXPECT_EQ(entry().published.model->cameras.size(), model->cameras.size());
    ASSERT_TRUE(use().ok());
    EXPECT_FALSE(entry().published.rests);
    EXPECT_EQ(entry().material.models.front().model, entry().published.model);
    ASSERT_EQ(entry().published.model->points.size(), model->points.size());
    for (std::size_t p = 0; p < model->points.size(); ++p) {
        EXPECT_EQ(entry().published.model->points[p].position, model->points[p].position);
        EXPECT_EQ(entry().published.model->points[p].track, model->points[p].track);
    }
}

TEST_F(ResidentModelsTest, KeepsWhatWasUsedLately) {
    let_uses_pass(ResidentModels::kUsesKept - 1);
    models_.release(table_);
    EXPECT_FALSE(entry().published.rests);
    let_uses_pass(1);
    models_.set_budget(entry().published.model->points.bytes());
    models_.release(table_);
    EXPECT_FALSE(entry().published.rests) << "within the budget";
    models_.set_budget(entry().published.model->points.bytes() - 1);
    models_.release(table_);
    EXPECT_TRUE(entry().published.rests);
}

TEST_F(ResidentModelsTest, KeepsWhatTheStoreMayNotHave) {
    let_uses_pass(ResidentModels::kUsesKept);
    table_.make_dirty(std::span(&kCluster, 1));
    models_.release(table_);
    EXPECT_FALSE(entry().published.rests) << "to be solved";
    table_.take_dirty();
    models_.release(table_);
    EXPECT_FALSE(entry().published.rests) << "being solved";
}

TEST_F(ResidentModelsTest, SaysWhatIsNotInTheStore) {
    ClusterEntry newer = entry();
    ++newer.published.revision;
    restore(newer);
    let_uses_pass(ResidentModels::kUsesKept);
    models_.release(table_);
    ASSERT_TRUE(entry().published.rests);
    const auto read = use();
    ASSERT_FALSE(read.ok());
    EXPECT_NE(read.error().message.find("cluster 0"), std::string::npos) << read.error().message;
}

/// A wall in parts of twelve images with weak edges between them, and two more images of the first
/// part at the end.
struct Wall {
    static constexpr std::uint32_t kOfPart = 12;
    static constexpr std::uint32_t kParts = 4;
    static constexpr std::uint32_t kImages = kParts * kOfPart;
    static constexpr std::uint32_t kLast = 2;  // images of the first part that come last
    synthetic::SyntheticScene scene;
    std::vector<VerifiedPairPtr> pairs;

    Wall() {
        std::vector<std::size_t> order;
        for (std::size_t i = kLast; i < kImages; ++i) order.push_back(i);
        for (std::size_t i = 0; i < kLast; ++i) order.push_back(i);
        scene = synthetic::reorder_images(
            synthetic::make_scene(synthetic::line_along_wall(kImages), 3), order);
        const auto part = [&](ImageId image) { return order[index_of(image)] / kOfPart; };
        for (const VerifiedPairPtr& pair : synthetic::make_verified_pairs(scene)) {
            VerifiedPair kept = *pair;
            auto& inliers = kept.geometry.inliers;
            if (part(kept.pair.first) != part(kept.pair.second)) {
                const auto [from, to] = std::minmax(order[index_of(kept.pair.first)],
                                                    order[index_of(kept.pair.second)]);
                if (to - from > 2) continue;
                inliers.resize(std::min<std::size_t>(inliers.size(), 40));
            }
            pairs.push_back(std::make_shared<const VerifiedPair>(kept));
        }
    }
};

/// Images placed by both, as long as they are the same to the last bit.
std::size_t placed_alike(const Scene& kept_scene, const Scene& read_scene) {
    EXPECT_EQ(kept_scene.clusters.size(), read_scene.clusters.size());
    std::size_t placed = 0;
    for (std::size_t c = 0; c < kept_scene.clusters.size(); ++c) {
        const auto& kept = kept_scene.clusters[c]->model;
        const auto& read = read_scene.clusters[c]->model;
        EXPECT_EQ(kept == nullptr, read == nullptr);
        if (!kept || !read || kept->images.size() != read->images.size() ||
            kept->points.size() != read->points.size()) {
            EXPECT_EQ(kept, read) << "cluster " << c;
            continue;
        }
        placed += kept->images.size();
        for (std::size_t i = 0; i < kept->images.size(); ++i) {
            EXPECT_EQ(kept->images[i].cam_from_cluster.translation,
                      read->images[i].cam_from_cluster.translation);
        }
        for (std::size_t p = 0; p < kept->points.size(); ++p)
            EXPECT_EQ(kept->points[p].position, read->points[p].position);
    }
    return placed;
}

TEST(ModelsOfASession, RestAndChangeNothing) {
    const Wall wall;
    std::vector<Scene> scenes;
    for (const std::size_t budget : {std::size_t{1} << 30U, std::size_t{0}}) {
        const testing::TemporaryFolder folder;
        const auto store = test::open_store(folder);
        SerialSession session(*store, wall.scene, wall.pairs, true, {.join_below = 0}, {},
                              {.idle_bytes = budget});
        const ClusterTable& clusters = session.state().clusters;
        for (std::uint32_t i = 0; i + Wall::kLast < Wall::kImages; ++i)
            ASSERT_TRUE(session.add_image());
        ASSERT_GE(clusters.entries().size(), 3U);
        ASSERT_EQ(session.state().counts.effective_clusters, 1U);
        EXPECT_EQ(clusters.of(ImageId{0}).published.rests, budget == 0);
        for (const auto& shown : session.state().scene->clusters) {
            const ClusterEntry& entry = clusters.entries().at(shown->id);
            EXPECT_EQ(shown->model, entry.published.model) << "nobody else has the points";
        }
        ASSERT_TRUE(session.add_image());
        ASSERT_TRUE(session.add_image());
        EXPECT_FALSE(clusters.of(ImageId{0}).published.rests);
        session.end();
        auto scene = store->scene();
        ASSERT_TRUE(scene.ok());
        scenes.push_back(*std::move(scene));
    }
    EXPECT_GE(placed_alike(scenes[0], scenes[1]), Wall::kImages - 1)
        << "one is left out between two parts";
}

/// Two parts of a wall, and two images that stand between them and come one by one after images of
/// another wall: the first is one more of a part, the second joins the parts.
struct Bridge {
    static constexpr std::uint32_t kOfPart = 8;
    static constexpr std::uint32_t kOther = 15;  // before each of the two
    static constexpr std::uint32_t kImages = 2 * kOfPart + 2 + 2 * kOther;
    synthetic::SyntheticScene scene;
    std::vector<VerifiedPairPtr> pairs;

    Bridge() {
        constexpr std::size_t kOfWall = 2 * kOfPart + 2;
        std::vector<std::size_t> order;
        for (std::size_t i = 0; i < kOfWall; ++i) {
            if (i != kOfPart && i != kOfPart + 1) order.push_back(i);
        }
        for (const std::size_t between : {0U, 1U}) {
            for (std::size_t i = 0; i < kOther; ++i)
                order.push_back(kOfWall + between * kOther + i);
            order.push_back(kOfPart + between);
        }
        scene = synthetic::reorder_images(
            synthetic::make_scene(synthetic::line_along_wall(kImages), 3), order);
        const auto part = [&](ImageId image) {
            const std::size_t place = order[index_of(image)];
            if (place >= kOfWall) return 3;
            if (place == kOfPart || place == kOfPart + 1) return 2;
            return place < kOfPart ? 0 : 1;
        };
        for (const VerifiedPairPtr& pair : synthetic::make_verified_pairs(scene)) {
            const int one = part(pair->pair.first);
            const int other = part(pair->pair.second);
            const bool is_bridge = (one == 2 && other < 2) || (other == 2 && one < 2);
            if (one == other || is_bridge) pairs.push_back(pair);
        }
    }
};

TEST(ModelsOfASession, AreAwakeWhenTheirClustersJoin) {
    const Bridge bridge;
    const testing::TemporaryFolder folder;
    const auto store = test::open_store(folder);
    SerialSession session(*store, bridge.scene, bridge.pairs, true,
                          ClusteringOptions{.join_below = 0}, {.mu_min = 5}, {.idle_bytes = 0});
    const ClusterTable& clusters = session.state().clusters;
    for (std::uint32_t i = 0; i + 1 < Bridge::kImages; ++i) ASSERT_TRUE(session.add_image());
    const ImageId of_first{Bridge::kOfPart - 1};
    const ImageId of_second{Bridge::kOfPart};
    ASSERT_NE(clusters.of(of_first).id, clusters.of(of_second).id);
    ASSERT_TRUE(clusters.of(of_first).published.rests);
    ASSERT_TRUE(clusters.of(of_second).published.rests);
    session.hold_solves();
    ASSERT_TRUE(session.add_image());
    const ClusterEntry& joined = clusters.of(of_first);
    ASSERT_EQ(joined.id, clusters.of(of_second).id);
    ASSERT_EQ(joined.material.models.size(), 2U);
    for (const RecycledModel& material : joined.material.models)
        EXPECT_FALSE(material.model->points.empty());
    session.release_solves();
    EXPECT_EQ(clusters.of(of_first).published.model->images.size(), 2U * Bridge::kOfPart + 2U);
}

TEST(ModelsOfASession, SettleAFewAtATime) {
    const Wall wall;
    for (const bool is_deterministic : {false, true}) {
        const testing::TemporaryFolder folder;
        const auto store = test::open_store(folder);
        SerialSession session(*store, wall.scene, wall.pairs, is_deterministic, {.join_below = 0},
                              {}, {.settle_at_once = 2});
        for (std::uint32_t i = 0; i < Wall::kImages; ++i) ASSERT_TRUE(session.add_image());
        const std::size_t models = session.state().counts.clusters;
        ASSERT_GE(models, 3U);
        session.hold_solves();
        session.end();
        EXPECT_EQ(session.held_solves(), is_deterministic ? models : 2U);
        session.release_solves();
        EXPECT_EQ(session.state().counts.solves_settle, models);
        EXPECT_FALSE(session.state().clusters.busy());
        for (const auto& [id, entry] : session.state().clusters.entries()) {
            if (entry.published.model) {
                EXPECT_TRUE(entry.published.settled) << index_of(id);
            }
        }
        EXPECT_EQ(
            std::ranges::count(session.events(), SessionEvent::Kind::kSettle, &SessionEvent::kind),
            1);
        EXPECT_EQ(session.state().scene->version, store->scene()->version);
        for (const auto& shown : session.state().scene->clusters) {
            EXPECT_EQ(shown->revision,
                      session.state().clusters.entries().at(shown->id).published.revision)
                << "settled models are published";
        }
    }
}

}  // namespace
}  // namespace psfm
