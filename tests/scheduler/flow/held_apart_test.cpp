// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Clusters that are held apart for their size, through a whole session.
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "tests/scheduler/flow/serial_session.h"
#include "tests/storage/random_values.h"
#include "tests/storage/test_session.h"
#include "tests/synthetic/compare.h"
#include "tests/synthetic/verified_pairs.h"

namespace psfm {
namespace {

using test::SerialSession;

constexpr std::uint32_t kImages = 24;
constexpr ClusteringOptions kClustering{.join_up_to = 14, .hold_part = 0.28};  // from 4 on

/// A ring that two people walk along, half of it each.
struct Ring {
    synthetic::SyntheticScene scene;
    std::vector<VerifiedPairPtr> pairs;

    Ring() {
        std::vector<std::size_t> order;
        for (std::size_t i = 0; i < kImages / 2; ++i) {
            order.push_back(i);
            order.push_back(kImages / 2 + i);
        }
        scene = synthetic::reorder_images(
            synthetic::make_scene(synthetic::ring_around_sphere(kImages), 5), order);
        pairs = synthetic::make_verified_pairs(scene);
    }
};

/// Two clusters, each too large to join the other, with all images in their models.
void expect_two_models(const SerialSession& session) {
    const auto& entries = session.state().clusters.entries();
    ASSERT_EQ(entries.size(), 2U);
    std::size_t placed = 0;
    for (const auto& [id, entry] : entries) {
        ASSERT_NE(entry.published.model, nullptr);
        EXPECT_GE(entry.published.model->images.size(), 4U);
        placed += entry.published.model->images.size();
    }
    EXPECT_EQ(placed, kImages);
}

std::shared_ptr<const Reconstruction> only_model(const SerialSession& session) {
    EXPECT_EQ(session.state().clusters.entries().size(), 1U);
    return session.state().clusters.entries().begin()->second.published.model;
}

class HeldApart : public ::testing::Test {
  protected:
    SerialSession open(SessionStore& store) const {
        return SerialSession(store, ring_.scene, ring_.pairs, true, kClustering);
    }
    void expect_whole(const SerialSession& session) const {
        const auto model = only_model(session);
        ASSERT_NE(model, nullptr);
        EXPECT_EQ(model->images.size(), kImages);
        EXPECT_TRUE(session.state().clusters.entries().begin()->second.published.settled);
        const auto error = synthetic::compare_with_truth(*model, ring_.scene);
        ASSERT_TRUE(error.ok());
        EXPECT_LT(error->max_position, 0.01);
    }

    Ring ring_;
    testing::TemporaryFolder folder_;
};

TEST_F(HeldApart, AreOneFrameWhileImagesComeAndOneModelInTheEnd) {
    const auto store = test::open_store(folder_);
    SerialSession session = open(*store);
    for (std::uint32_t i = 0; i < kImages; ++i) ASSERT_TRUE(session.add_image());
    expect_two_models(session);
    EXPECT_EQ(session.state().counts.placed, kImages);
    EXPECT_EQ(session.state().counts.effective_clusters, 1U);
    session.end();
    expect_whole(session);
}

TEST_F(HeldApart, AProcessThatEndedMeanwhileMakesNoDifference) {
    const testing::TemporaryFolder other;
    const auto whole_store = test::open_store(other);
    SerialSession whole = open(*whole_store);
    for (std::uint32_t i = 0; i < kImages; ++i) ASSERT_TRUE(whole.add_image());
    whole.end();
    {
        const auto store = test::open_store(folder_);
        SerialSession session = open(*store);
        for (std::uint32_t i = 0; i < kImages; ++i) ASSERT_TRUE(session.add_image());
    }
    {
        // Ends while what was joined is solved.
        const auto store = test::open_store(folder_);
        SerialSession session = open(*store);
        expect_two_models(session);
        session.hold_solves();
        session.end();
        ASSERT_EQ(session.held_solves(), 1U);
        EXPECT_EQ(session.held().front().problem->recycled.size(), 2U);
    }
    const auto store = test::open_store(folder_);
    SerialSession session = open(*store);
    session.end();
    expect_whole(session);
    EXPECT_TRUE(testing::same_poses(*only_model(session), *only_model(whole)));
    EXPECT_TRUE(testing::same_points(*only_model(session), *only_model(whole)));
    EXPECT_TRUE(store->check({})->damaged.empty());
}

}  // namespace
}  // namespace psfm
