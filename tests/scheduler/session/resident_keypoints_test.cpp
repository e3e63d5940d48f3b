// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/session/resident_keypoints.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/scheduler/flow/serial_session.h"
#include "tests/storage/test_session.h"
#include "tests/synthetic/verified_pairs.h"

namespace psfm {
namespace {

using test::SerialSession;

bool never(ImageId) {
    return false;
}
bool always(ImageId) {
    return true;
}

class ResidentKeypointsTest : public ::testing::Test {
  protected:
    static constexpr std::uint32_t kImages = 4;

    ResidentKeypointsTest() : store_(test::open_store(folder_)) {
        EXPECT_TRUE(testing::finish(*store_, kImages));
        for (std::uint32_t image = 0; image < kImages; ++image) {
            keypoints_.push_back(
                std::make_shared<const Keypoints>(testing::expected_keypoints(image)));
        }
    }
    /// Other solves, none of which uses anything.
    void let_solves_pass(std::uint64_t solves) {
        for (std::uint64_t i = 0; i < solves; ++i) EXPECT_TRUE(keypoints_.use({}, *store_).ok());
    }
    std::vector<bool> resident() const {
        std::vector<bool> images;
        for (std::uint32_t i = 0; i < kImages; ++i) images.push_back(keypoints_[i] != nullptr);
        return images;
    }

    testing::TemporaryFolder folder_;
    std::unique_ptr<SessionStore> store_;
    ResidentKeypoints keypoints_;
};

TEST_F(ResidentKeypointsTest, LetsGoOfWhatWasUsedLongestAgoAndReadsItBack) {
    const std::size_t all = keypoints_.bytes();
    keypoints_.set_budget(all / 2);
    const std::vector<ImageId> used{ImageId{0}, ImageId{2}};
    EXPECT_TRUE(keypoints_.use(used, *store_).ok());
    let_solves_pass(ResidentKeypoints::kSolvesKept);
    keypoints_.release(always);
    EXPECT_EQ(resident(), (std::vector<bool>{true, false, true, false}));
    EXPECT_EQ(keypoints_.bytes(), all / 2);
    const std::vector<ImageId> wanted{ImageId{1}};
    ASSERT_TRUE(keypoints_.use(wanted, *store_).ok());
    EXPECT_EQ(*keypoints_[1], testing::expected_keypoints(1));
    EXPECT_EQ(keypoints_.bytes(), 3 * all / 4);
}

TEST_F(ResidentKeypointsTest, KeepsWhatIsInUse) {
    keypoints_.set_budget(0);
    let_solves_pass(ResidentKeypoints::kSolvesKept - 1);
    keypoints_.release(always);
    EXPECT_EQ(resident(), std::vector<bool>(kImages, true)) << "used lately";
    let_solves_pass(1);
    keypoints_.release(never);
    EXPECT_EQ(resident(), std::vector<bool>(kImages, true)) << "asked for by others";
    keypoints_.release(always);
    EXPECT_EQ(resident(), std::vector<bool>(kImages, true)) << "not gone through again at once";
    keypoints_.set_budget(0);
    keypoints_.release(always);
    EXPECT_EQ(resident(), std::vector<bool>(kImages, false));
    EXPECT_EQ(keypoints_.bytes(), 0U);
}

TEST_F(ResidentKeypointsTest, SaysWhatTheStoreCannotRead) {
    keypoints_.push_back(keypoints_[0]);  // an image that the store does not have
    keypoints_.set_budget(0);
    let_solves_pass(ResidentKeypoints::kSolvesKept);
    keypoints_.release(always);
    const std::vector<ImageId> wanted{ImageId{kImages}};
    EXPECT_FALSE(keypoints_.use(wanted, *store_).ok());
}

/// Two walls that have nothing in common: ten images of one, 48 of the other, two of the first.
struct TwoWalls {
    static constexpr std::uint32_t kFirst = 10;
    static constexpr std::uint32_t kBetween = 48;
    synthetic::SyntheticScene scene;
    std::vector<VerifiedPairPtr> pairs;

    TwoWalls() {
        constexpr std::uint32_t kOfFirst = kFirst + 2;
        std::vector<std::size_t> order;
        for (std::size_t i = 0; i < kFirst; ++i) order.push_back(i);
        for (std::size_t i = 0; i < kBetween; ++i) order.push_back(kOfFirst + i);
        for (std::size_t i = kFirst; i < kOfFirst; ++i) order.push_back(i);
        scene = synthetic::reorder_images(
            synthetic::make_scene(synthetic::line_along_wall(kOfFirst + kBetween), 3), order);
        pairs = synthetic::make_verified_pairs(scene);
        std::erase_if(pairs, [&](const VerifiedPairPtr& pair) {
            return (order[index_of(pair->pair.first)] < kOfFirst) !=
                   (order[index_of(pair->pair.second)] < kOfFirst);
        });
    }
};

TEST(KeypointsOfASession, LeaveMemoryAndChangeNothing) {
    const TwoWalls walls;
    std::vector<ScenePtr> scenes;
    for (const std::size_t budget : {std::size_t{1} << 30U, std::size_t{0}}) {
        const testing::TemporaryFolder folder;
        const auto store = test::open_store(folder);
        SerialSession session(*store, walls.scene, walls.pairs, true, {.join_below = 0}, {},
                              {.idle_bytes = budget});
        for (std::uint32_t i = 0; i < TwoWalls::kFirst + TwoWalls::kBetween; ++i)
            ASSERT_TRUE(session.add_image());
        EXPECT_EQ(session.state().photographs.keypoints[0] == nullptr, budget == 0);
        ASSERT_TRUE(session.add_image());
        ASSERT_TRUE(session.add_image());
        session.end();
        scenes.push_back(session.state().scene);
    }
    ASSERT_EQ(scenes[0]->clusters.size(), scenes[1]->clusters.size());
    std::size_t placed = 0;
    for (std::size_t c = 0; c < scenes[0]->clusters.size(); ++c) {
        const auto& kept = scenes[0]->clusters[c]->model;
        const auto& read = scenes[1]->clusters[c]->model;
        ASSERT_EQ(kept == nullptr, read == nullptr);
        if (!kept) continue;
        ASSERT_EQ(kept->images.size(), read->images.size());
        placed += kept->images.size();
        for (std::size_t i = 0; i < kept->images.size(); ++i) {
            EXPECT_EQ(kept->images[i].cam_from_cluster.translation,
                      read->images[i].cam_from_cluster.translation);
        }
    }
    EXPECT_EQ(placed, TwoWalls::kFirst + TwoWalls::kBetween + 2);
}

}  // namespace
}  // namespace psfm
