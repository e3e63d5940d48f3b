// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The life of an image that its own cluster cannot place, through a whole session.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/scheduler/flow/serial_session.h"
#include "tests/storage/test_session.h"
#include "tests/synthetic/compare.h"
#include "tests/synthetic/disturb.h"
#include "tests/synthetic/verified_pairs.h"

namespace psfm {
namespace {

using test::SerialSession;

constexpr std::uint32_t kInFirst = 7;  // images 0 … 6
constexpr std::uint32_t kImages = 13;
constexpr ImageId kStray{kImages - 1};  // stands beside the second cluster

/// Two parts of a ring with a few edges between them. Image kStray has strong edges to the first
/// part, and so belongs to its cluster; but no two of them share a feature, and nothing that it
/// sees there is ever a point. Its weaker edges to the second part are true.
struct TwoParts {
    synthetic::SyntheticScene scene;
    std::vector<VerifiedPairPtr> pairs;

    /// @param images  kImages: the stray arrives last; or one more, that joins the second part
    /// @param known_to  the stray's edges to the second part: to images from this one on
    explicit TwoParts(std::uint32_t images = kImages, std::uint32_t known_to = kImages - 4)
        : scene(synthetic::add_clutter(
              synthetic::make_scene(synthetic::ring_around_sphere(images), 7), 600, 8)) {
        for (const VerifiedPairPtr& pair : synthetic::make_verified_pairs(scene)) {
            const auto [first, second] = pair->pair;
            const bool same_part = (index_of(first) < kInFirst) == (index_of(second) < kInFirst);
            const bool across = index_of(first) + 2 >= kInFirst && index_of(second) < kInFirst + 2;
            VerifiedPair kept = *pair;
            if (first == kStray || second == kStray) {
                if (index_of(first == kStray ? second : first) < known_to) continue;
                shorten(kept, 45);
            } else if (!same_part) {
                if (!across) continue;
                shorten(kept, 40);
            }
            pairs.push_back(std::make_shared<const VerifiedPair>(kept));
        }
        for (std::uint32_t image = 0; image < kInFirst; ++image) pairs.push_back(unfounded(image));
        std::ranges::sort(pairs, {}, [](const VerifiedPairPtr& pair) { return pair->pair; });
    }

    static void shorten(VerifiedPair& pair, std::size_t count) {
        auto& inliers = pair.geometry.inliers;
        inliers.resize(std::min(inliers.size(), count));
    }

    /// Matches of features that nothing else is matched with.
    VerifiedPairPtr unfounded(std::uint32_t image) const {
        VerifiedPair pair = synthetic::make_verified_pair(scene, {ImageId{image}, kStray}, {});
        const auto first = static_cast<std::uint32_t>(scene.images[image].keypoints.size()) - 600;
        const auto second =
            static_cast<std::uint32_t>(scene.images[index_of(kStray)].keypoints.size()) - 600;
        pair.geometry.inliers.clear();
        for (std::uint32_t k = 0; k < 80; ++k)
            pair.geometry.inliers.push_back({first + 80 * image + k, second + 80 * image + k});
        return std::make_shared<const VerifiedPair>(pair);
    }
};

std::vector<SessionEvent> adoptions(const SerialSession& session) {
    std::vector<SessionEvent> found;
    std::ranges::copy_if(session.events(), std::back_inserter(found), [](const auto& event) {
        return event.kind == SessionEvent::Kind::kAdopt;
    });
    return found;
}

const SceneCluster* cluster_that_places(const Scene& scene, ImageId image) {
    for (const auto& cluster : scene.clusters) {
        if (cluster->model && cluster->model->find(image) != nullptr) return cluster.get();
    }
    return nullptr;
}

TEST(Adoption, AnImageIsPlacedByTheClusterThatKnowsItsSurroundings) {
    const TwoParts parts;
    const testing::TemporaryFolder folder;
    const auto store = test::open_store(folder);
    SerialSession session(*store, parts.scene, parts.pairs);
    for (std::uint32_t i = 0; i + 1 < kImages; ++i) ASSERT_TRUE(session.add_image());
    ASSERT_EQ(session.state().clustering.members.size(), 2U);
    ASSERT_EQ(session.state().counts.placed, kImages - 1);
    ASSERT_TRUE(adoptions(session).empty());

    ASSERT_TRUE(session.add_image());
    const auto events = adoptions(session);
    ASSERT_EQ(events.size(), 1U);
    EXPECT_EQ(events[0].images, std::vector{std::to_string(index_of(kStray))});
    const ClusterId own = session.state().clustering.cluster_of[index_of(kStray)];
    EXPECT_EQ(own, session.state().clustering.cluster_of[0]);
    const SceneCluster* host = cluster_that_places(*session.state().scene, kStray);
    ASSERT_NE(host, nullptr);
    EXPECT_NE(host->id, own);
    const auto error = synthetic::compare_with_truth(*host->model, parts.scene);
    ASSERT_TRUE(error.ok());
    EXPECT_LT(error->max_position, 0.01);
    EXPECT_EQ(session.state().counts.placed, kImages);
    EXPECT_EQ(session.reported().back(), kImages) << "reported once it has its place";
    const auto settling = [&] {
        return std::ranges::count(session.events(), SessionEvent::Kind::kSettle,
                                  &SessionEvent::kind);
    };
    EXPECT_EQ(settling(), 0);
    session.end();
    EXPECT_EQ(settling(), 1) << "all models at once";
    EXPECT_EQ(session.state().counts.placed, kImages);
    EXPECT_EQ(adoptions(session).size(), 1U);
    for (const auto& [id, entry] : session.state().clusters.entries())
        EXPECT_TRUE(entry.published.settled);
}

TEST(Adoption, OutlastsImagesThatArriveAfterIt) {
    const TwoParts parts(kImages + 1);
    const testing::TemporaryFolder folder;
    const auto store = test::open_store(folder);
    SerialSession session(*store, parts.scene, parts.pairs);
    for (std::uint32_t i = 0; i < kImages; ++i) ASSERT_TRUE(session.add_image());
    ASSERT_EQ(adoptions(session).size(), 1U);
    const ClusterId host = cluster_that_places(*session.state().scene, kStray)->id;
    ASSERT_TRUE(session.add_image());
    session.end();
    EXPECT_EQ(cluster_that_places(*session.state().scene, kStray)->id, host);
    EXPECT_EQ(adoptions(session).size(), 1U) << "it was not given back in between";
    EXPECT_EQ(session.state().counts.placed, kImages + 1);
}

TEST(Adoption, IsDoneBeforeTheImageThatBroughtItAboutIsReported) {
    // The stray shares enough with the last image alone.
    const TwoParts parts(kImages + 1, kImages);
    const testing::TemporaryFolder folder;
    const auto store = test::open_store(folder);
    SerialSession session(*store, parts.scene, parts.pairs);
    for (std::uint32_t i = 0; i < kImages; ++i) ASSERT_TRUE(session.add_image());
    ASSERT_TRUE(adoptions(session).empty());
    ASSERT_EQ(session.state().counts.placed, kImages - 1);
    ASSERT_TRUE(session.add_image());
    ASSERT_EQ(adoptions(session).size(), 1U);
    EXPECT_EQ(session.reported().back(), kImages + 1);
    EXPECT_EQ(session.placed_when_reported().back(), kImages + 1)
        << "a deterministic session admits the next image only now";
}

TEST(Adoption, SurvivesACrashAfterEachMessage) {
    const TwoParts parts;
    ScenePtr expected;
    {
        const testing::TemporaryFolder folder;
        const auto store = test::open_store(folder);
        SerialSession session(*store, parts.scene, parts.pairs);
        for (std::uint32_t i = 0; i < kImages; ++i) ASSERT_TRUE(session.add_image());
        session.end();
        expected = session.state().scene;
    }
    std::size_t crashes = 0;
    for (bool done = false; !done; ++crashes) {
        const testing::TemporaryFolder folder;
        {
            const auto store = test::open_store(folder);
            SerialSession session(*store, parts.scene, parts.pairs);
            for (std::uint32_t i = 0; i + 1 < kImages; ++i) ASSERT_TRUE(session.add_image());
            done = session.add_image(crashes + 1);
        }
        const auto store = test::open_store(folder);
        SerialSession resumed(*store, parts.scene, parts.pairs);
        resumed.end();
        const SceneCluster* host = cluster_that_places(*resumed.state().scene, kStray);
        ASSERT_NE(host, nullptr) << "after " << crashes + 1 << " messages";
        const SceneCluster* undisturbed = cluster_that_places(*expected, kStray);
        EXPECT_EQ(host->id, undisturbed->id);
        EXPECT_EQ(host->members, undisturbed->members);
        EXPECT_EQ(host->model->find(kStray)->cam_from_cluster.translation,
                  undisturbed->model->find(kStray)->cam_from_cluster.translation);
        EXPECT_TRUE((*store).check({})->damaged.empty());
    }
    EXPECT_GE(crashes, 6U) << "accepted, verified, solved, merged, solved again, merged again";
}

}  // namespace
}  // namespace psfm
