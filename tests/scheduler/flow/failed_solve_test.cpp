// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Solves that fail, for want of memory for instance, through a whole session.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <set>

#include "scheduler/report/describe_events.h"
#include "tests/scheduler/flow/serial_session.h"
#include "tests/stages/reconstruction/two_parts.h"
#include "tests/storage/test_session.h"

namespace psfm {
namespace {

using test::SerialSession;

std::size_t failures_told(const SerialSession& session) {
    return static_cast<std::size_t>(std::ranges::count_if(
        session.events(),
        [](const SessionEvent& event) { return event.text.starts_with("solve failed"); }));
}

/// Two models that are joined once no image follows.
class FailedSolve : public ::testing::Test {
  protected:
    /// A session of all images, or what there is of it.
    std::unique_ptr<SerialSession> open(SessionStore& store) const {
        auto session =
            std::make_unique<SerialSession>(store, parts_.scene, pairs_, true, ClusteringOptions{});
        while (session->state().verified < TwoParts::kImages) session->add_image();
        return session;
    }
    /// What a session ends as that nothing fails in.
    ScenePtr undisturbed() const {
        const testing::TemporaryFolder folder;
        const auto store = test::open_store(folder);
        const auto session = open(*store);
        session->end();
        return session->state().scene;
    }
    /// Where all solves fail, a later process that takes the session up ends as this.
    void expect_same_after_restart(const testing::TemporaryFolder& folder) const {
        const auto store = test::open_store(folder);
        const auto resumed = open(*store);
        EXPECT_EQ(describe_failures(resumed->state().clusters), std::nullopt);
        resumed->end();
        const ScenePtr expected = undisturbed();
        const ScenePtr scene = resumed->state().scene;
        ASSERT_EQ(scene->clusters.size(), expected->clusters.size());
        for (std::size_t i = 0; i < scene->clusters.size(); ++i) {
            const Reconstruction& model = *scene->clusters[i]->model;
            const Reconstruction& other = *expected->clusters[i]->model;
            ASSERT_EQ(model.images.size(), other.images.size());
            for (std::size_t k = 0; k < model.images.size(); ++k) {
                EXPECT_EQ(model.images[k].cam_from_cluster.translation,
                          other.images[k].cam_from_cluster.translation);
            }
        }
        for (const auto& [id, entry] : resumed->state().clusters.entries())
            EXPECT_TRUE(entry.published.settled);
        EXPECT_TRUE(store->check({})->damaged.empty());
    }

    TwoParts parts_;
    std::vector<VerifiedPairPtr> pairs_ = parts_.pairs(0.7, 0);
};

TEST_F(FailedSolve, OfAJoinKeepsBothModelsForTheNextProcess) {
    const testing::TemporaryFolder folder;
    {
        const auto store = test::open_store(folder);
        const auto session = open(*store);
        ASSERT_EQ(session->state().clusters.entries().size(), 2U);
        ASSERT_EQ(session->state().counts.placed, TwoParts::kImages);
        const ClusterId own = session->state().clustering.cluster_of[0];
        const auto model = session->state().clusters.entries().at(own).published.model;
        session->fail_solves();
        session->end();
        EXPECT_EQ(failures_told(*session), 1U) << "tried once";
        ASSERT_EQ(session->state().clusters.entries().size(), 1U);
        const ClusterEntry& entry = session->state().clusters.entries().begin()->second;
        EXPECT_EQ(entry.id, own);
        EXPECT_EQ(entry.published.model, model) << "shown as it was";
        EXPECT_EQ(session->state().scene->clusters.front()->model->images.size(), TwoParts::kLeft);
        const auto waiting = waiting_images(session->state());
        EXPECT_EQ(waiting.size(), TwoParts::kImages - TwoParts::kLeft);
        for (const auto& [image, reason] : waiting) EXPECT_EQ(reason, WaitReason::kSolving);
        const auto told = describe_failures(session->state().clusters);
        ASSERT_TRUE(told);
        EXPECT_NE(told->find("(12 images) could not be solved: not enough memory"),
                  std::string::npos)
            << *told;
    }
    expect_same_after_restart(folder);
}

TEST_F(FailedSolve, ThatWasToSettleIsDoneByTheNextProcess) {
    const testing::TemporaryFolder folder;
    {
        const auto store = test::open_store(folder);
        const auto session = open(*store);
        session->hold_solves();
        session->end();
        session->release_held();  // joined; what settles is held
        ASSERT_EQ(session->held_solves(), 1U);
        ASSERT_TRUE(session->held().front().problem->settle);
        const ScenePtr shown = session->state().scene;
        session->fail_solves();
        session->release_solves();
        EXPECT_EQ(failures_told(*session), 1U) << "tried once";
        const ClusterEntry& entry = session->state().clusters.entries().begin()->second;
        EXPECT_FALSE(entry.published.settled);
        EXPECT_EQ(session->state().scene, shown) << "nothing has changed";
        EXPECT_TRUE(waiting_images(session->state()).empty());
        EXPECT_TRUE(describe_failures(session->state().clusters));
    }
    expect_same_after_restart(folder);
}

TEST_F(FailedSolve, IsDoneAgainForTheNextImage) {
    const testing::TemporaryFolder folder;
    const auto store = test::open_store(folder);
    SerialSession session(*store, parts_.scene, pairs_);
    for (int i = 0; i < 4; ++i) ASSERT_TRUE(session.add_image());
    session.fail_solves();
    ASSERT_TRUE(session.add_image());
    EXPECT_EQ(session.state().counts.placed, 4U);
    EXPECT_EQ(session.reported().size(), 5U) << "the session goes on, and says why it waits";
    ASSERT_TRUE(describe_failures(session.state().clusters));
    session.fail_solves(false);
    ASSERT_TRUE(session.add_image());
    EXPECT_EQ(session.state().counts.placed, 6U);
    EXPECT_FALSE(describe_failures(session.state().clusters));
}

}  // namespace
}  // namespace psfm
