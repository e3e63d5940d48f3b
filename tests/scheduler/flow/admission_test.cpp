// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// When images give back the tokens that let others in, and when a version shows them.
#include "scheduler/flow/admission.h"

#include <gtest/gtest.h>

#include <vector>

#include "scheduler/session/remove_images.h"
#include "tests/scheduler/flow/serial_session.h"
#include "tests/storage/test_session.h"
#include "tests/synthetic/verified_pairs.h"

namespace psfm {
namespace {

constexpr std::uint32_t kAlone = 50;       // images that match nothing, two times 25
constexpr std::uint32_t kTogether = 8;     // that make one cluster, after those
constexpr std::uint32_t kBeforeModel = 4;  // of which are too few for a model

struct AloneAndTogether {
    synthetic::SyntheticScene scene =
        synthetic::make_scene(synthetic::ring_around_sphere(kAlone + kTogether), 3);
    std::vector<VerifiedPairPtr> pairs;

    AloneAndTogether() {
        for (const VerifiedPairPtr& pair : synthetic::make_verified_pairs(scene)) {
            if (index_of(pair->pair.first) >= kAlone) pairs.push_back(pair);
        }
    }
};

class AdmissionTest : public ::testing::Test {
  protected:
    /// A session in which the model of the last images is being solved.
    /// @param tokens  outlive it
    std::unique_ptr<test::SerialSession> solving(bool deterministic,
                                                 const Admission* tokens = nullptr) {
        auto opened = SessionStore::open(folder_.session(), {});
        EXPECT_TRUE(opened.ok());
        store_ = *std::move(opened);
        auto session = std::make_unique<test::SerialSession>(
            *store_, images_.scene, images_.pairs, deterministic,
            ClusteringOptions{.join_below = 0}, SolvePolicy{},
            CommitterPace{.image_tokens = tokens});
        for (std::uint32_t i = 0; i < kAlone + kBeforeModel; ++i) session->add_image();
        start_ = session->released();
        session->hold_solves();
        return session;
    }

    testing::TemporaryFolder folder_;
    AloneAndTogether images_;
    std::unique_ptr<SessionStore> store_;
    std::uint32_t start_ = 0;
};

TEST_F(AdmissionTest, AFewImagesMayWaitForASolveWithoutKeepingOthersOut) {
    const auto session = solving(false);
    // One token was that of catching up.
    EXPECT_EQ(start_, 1 + kAlone + kBeforeModel) << "published, with or without a place";
    session->add_image();
    session->add_image();
    EXPECT_EQ(session->released(), start_ + 2);
    session->add_image();
    session->add_image();
    EXPECT_EQ(session->released(), start_ + 2) << "a 25th of the session waits already";
    session->release_solves();
    EXPECT_EQ(session->released(), start_ + 4) << "each image gives back one";
    EXPECT_EQ(session->reported().size(), kAlone + kTogether);
    EXPECT_EQ(session->state().counts.placed, kTogether);
}

TEST_F(AdmissionTest, ADeterministicSessionTakesOneAfterTheOther) {
    const auto session = solving(true);
    session->add_image();
    EXPECT_EQ(session->released(), start_);
    session->release_solves();
    EXPECT_EQ(session->released(), start_ + 1);
}

TEST_F(AdmissionTest, VersionsLeaveTimeForOtherWork) {
    const auto session = solving(false);
    session->release_solves();
    session->merges_take(1e9);
    session->add_image();
    const std::uint64_t before = session->state().scene->version;
    session->hold_solves();
    session->add_image();
    session->add_image();
    session->add_image();  // which keeps its token
    EXPECT_EQ(session->state().scene->version, before) << "a solve is under way";
    session->release_solves();
    EXPECT_GT(session->state().scene->version, before) << "there is no other work";
    EXPECT_EQ(session->state().counts.placed, kTogether);
    EXPECT_EQ(session->reported().size(), kAlone + kTogether);
}

TEST_F(AdmissionTest, AQuietMomentBetweenPhotographsIsNoTimeForAVersion) {
    const Admission tokens(1);
    const auto session = solving(false, &tokens);
    session->release_solves();
    session->merges_take(1e9);
    session->add_image();
    const std::uint64_t before = session->state().scene->version;
    session->add_image();
    EXPECT_EQ(session->state().scene->version, before) << "the next one may come in";
    session->idle();
    EXPECT_EQ(session->state().scene->version, before + 1) << "no photograph is there";
    session->add_image();
    session->idle();
    EXPECT_EQ(session->state().scene->version, before + 2);
    EXPECT_EQ(session->reported().size(), kAlone + kBeforeModel + 3);
}

TEST_F(AdmissionTest, AVersionIsBegunAtOnceWhenNothingComesInBeforeIt) {
    const Admission none(0);
    const auto session = solving(false, &none);
    session->release_solves();
    session->merges_take(1e9);
    for (int i = 0; i < 4; ++i) session->add_image();
    EXPECT_EQ(session->reported().size(), kAlone + kTogether);
}

TEST_F(AdmissionTest, AVersionShowsModelsThatAreSolvedAgainMeanwhile) {
    const auto session = solving(false);
    session->release_solves();
    session->add_image();
    ASSERT_EQ(session->state().counts.placed, kBeforeModel + 1);
    session->hold_merges();
    session->add_image();  // verified: a merge begins; solved while that goes on
    session->hold_solves();
    session->add_image();  // the next solve goes on until the end
    session->release_merge();
    EXPECT_EQ(session->state().counts.placed, kBeforeModel + 1) << "the model as it was";
    session->release_merge();
    EXPECT_EQ(session->state().counts.placed, kBeforeModel + 2);
    EXPECT_EQ(session->reported().back(), kAlone + kBeforeModel + 2)
        << "it is placed, though its cluster is being solved for another image";
    const auto stored = store_->scene();
    ASSERT_TRUE(stored.ok());
    EXPECT_EQ(placed_count(*stored), kBeforeModel + 2) << "as it is read from the store";
}

TEST_F(AdmissionTest, SolvesThatCameToNothingAreCountedInAllProcesses) {
    std::uint32_t coalesced = 0;
    {
        const auto session = solving(false);
        session->add_image();
        session->add_image();  // overtakes the solve
        session->release_solves();
        coalesced = session->state().counts.solves_coalesced;
        ASSERT_GT(coalesced, 0U);
    }
    store_.reset();
    store_ = test::open_store(folder_);
    test::SerialSession next(*store_, images_.scene, images_.pairs, false);
    next.add_image();
    EXPECT_EQ(next.reported().size(), 1U);
    EXPECT_EQ(next.state().counts.solves_coalesced, coalesced);
}

TEST_F(AdmissionTest, OneThatWasTakenOutBeforeItHadPairsGivesItsTokenBackAndIsNotToldOf) {
    store_ = test::open_store(folder_);
    {
        test::SerialSession session(*store_, images_.scene, images_.pairs, false);
        ASSERT_TRUE(session.add_image());
        ASSERT_FALSE(session.add_image(1)) << "it is accepted, and the process ends";
    }
    ASSERT_EQ(store_->images()->size(), 2U);
    ASSERT_EQ(*store_->verified_image_count(), 1U);
    ASSERT_TRUE(remove_images(*store_, SessionConfig{}, std::vector{ImageId{1}}).ok());
    test::SerialSession session(*store_, images_.scene, images_.pairs, false);
    EXPECT_EQ(*store_->verified_image_count(), 2U) << "it keeps its place in their order";
    EXPECT_EQ(session.released(), 2U) << "its own, and that of catching up";
    EXPECT_TRUE(session.reported().empty());
    EXPECT_EQ(session.state().counts.images, 1U);
    EXPECT_EQ(session.state().counts.waiting, 1U);
}

}  // namespace
}  // namespace psfm
