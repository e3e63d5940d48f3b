// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/flow/cluster_keeper.h"

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "tests/scheduler/flow/serial_session.h"
#include "tests/scheduler/session/made_up_clusters.h"
#include "tests/storage/test_session.h"
#include "tests/synthetic/verified_pairs.h"

namespace psfm {
namespace {

/// Photographs along a wall, of which models say that they show two places, or one.
class Keeper : public ::testing::Test {
  protected:
    Keeper() {
        state_.photographs.images.resize(kImages);
        state_.photographs.sources.resize(kImages);
        while (next_ + 1 < kImages) add_image();
    }

    void add_image() {
        std::vector<VerifiedPairPtr> pairs;
        for (const VerifiedPairPtr& pair : all_) {
            if (pair->pair.second == ImageId{next_}) pairs.push_back(pair);
        }
        ASSERT_TRUE(keeper_.add_image(ImageId{next_}, pairs).ok());
        ++next_;
    }
    /// Of the first images.
    void show(const std::vector<std::vector<ImageId>>& places) {
        ClusterSolution solution;
        Reconstruction model;
        for (std::uint32_t i = 0; i + 1 < kImages; ++i)
            model.images.push_back({ImageId{i}, CameraId{0}, {}});
        solution.model = std::make_shared<const Reconstruction>(std::move(model));
        solution.places = places;
        ASSERT_TRUE(keeper_.separate(ClusterProblem{}, std::move(solution)).ok());
    }
    void show_two_places() {
        std::vector<std::vector<ImageId>> places(2);
        for (std::uint32_t i = 0; i + 1 < kImages; ++i)
            places[i < kImages / 2 ? 0 : 1].push_back(ImageId{i});
        show(places);
    }
    std::size_t apart() const { return state_.edges.apart_count; }

    static constexpr std::uint32_t kImages = 12;
    synthetic::SyntheticScene scene_ =
        synthetic::make_scene(synthetic::line_along_wall(kImages), 3);
    std::vector<VerifiedPairPtr> all_ = synthetic::make_verified_pairs(scene_);
    testing::TemporaryFolder folder_;
    std::unique_ptr<SessionStore> store_ = test::open_store(folder_);
    StageOptions options_;
    SessionState state_{3};
    Outbox outbox_;
    ClusterKeeper keeper_{*store_, options_, state_, outbox_};
    std::uint32_t next_ = 0;
};

TEST_F(Keeper, TakesBackWhatIsApartWhereAModelSaysOtherwise) {
    show_two_places();
    EXPECT_GT(apart(), 0U);
    show({});
    EXPECT_EQ(apart(), 0U);
}

/// A cluster that joins and shows one place, and parts that show two when they are by themselves,
/// would go on for ever.
TEST_F(Keeper, TakesAPairBackOnceUntilAnotherImageComes) {
    show_two_places();
    show({});
    show_two_places();
    const std::size_t before = apart();
    EXPECT_GT(before, 0U);
    show({});
    EXPECT_EQ(apart(), before);
    add_image();
    show({});
    EXPECT_EQ(apart(), 0U);
}

/// Three images, 0 to 2, and three, 3 to 5, of which the first has a few matches with the others.
class SmallClusters : public ::testing::Test {
  protected:
    SmallClusters() {
        options_.clustering.eta = 0.5;
        state_.photographs.images.resize(kImages);
        state_.photographs.sources.resize(kImages);
        add({});
        add({0});
        add({0, 1});
        add({0}, 30);
        add({3});
        add({3, 4});
        test::solve_dirty(state_.clusters);
    }

    /// The next image. @param others  that it has so many matches with
    void add(const std::vector<std::uint32_t>& others, std::uint32_t matches = 200) {
        const ImageId image{state_.verified};
        std::vector<VerifiedPairPtr> pairs;
        for (const std::uint32_t other : others) {
            VerifiedPair pair{{ImageId{other}, image}, {}};
            for (std::uint32_t i = 0; i < matches; ++i) pair.geometry.inliers.push_back({i, i});
            pairs.push_back(std::make_shared<const VerifiedPair>(std::move(pair)));
        }
        ASSERT_TRUE(keeper_.add_image(image, pairs).ok());
    }
    ClusterId own(std::uint32_t image) const { return state_.clustering.cluster_of[image]; }
    const ClusterEntry& entry(std::uint32_t image) const {
        return state_.clusters.entries().at(own(image));
    }
    std::optional<ClusterId> host(std::uint32_t image) const {
        return state_.clusters.hosts().host(ImageId{image});
    }

    static constexpr std::uint32_t kImages = 7;
    testing::TemporaryFolder folder_;
    std::unique_ptr<SessionStore> store_ = test::open_store(folder_);
    StageOptions options_;
    SessionState state_{3};
    Outbox outbox_;
    ClusterKeeper keeper_{*store_, options_, state_, outbox_};
};

TEST_F(SmallClusters, HaveTheirMembersBackWhenTheyGrowAgain) {
    ASSERT_NE(own(3), own(0));
    ASSERT_EQ(host(3), std::nullopt);
    const test::Solve shrinking = test::solve_of(entry(3), test::images({3, 4, 5}));
    ClusterSolution solution = shrinking.solution;
    solution.places = {test::images({3, 4}), test::images({5})};
    ASSERT_TRUE(keeper_.separate(shrinking.problem, std::move(solution)).ok());
    ASSERT_EQ(entry(3).membership.members, test::images({3, 4}));
    ASSERT_EQ(entry(3).published.revision, 1U) << "it had a model";
    ASSERT_EQ(host(3), own(0)) << "a guest, since its own cluster is too small";
    test::solve_dirty(state_.clusters);

    add({4});
    ASSERT_EQ(entry(3).membership.members, test::images({3, 4, 6}));
    EXPECT_EQ(host(3), std::nullopt) << "though none of its own edges has changed";
}

}  // namespace
}  // namespace psfm
