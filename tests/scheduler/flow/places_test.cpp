// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Two streets that one facade folds into one model, through a whole session.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <set>
#include <string>

#include "scheduler/session/encode_state.h"
#include "tests/scheduler/flow/serial_session.h"
#include "tests/stages/reconstruction/two_models.h"
#include "tests/stages/reconstruction/two_parts.h"
#include "tests/stages/reconstruction/two_streets.h"
#include "tests/storage/test_session.h"
#include "tests/synthetic/compare.h"
#include "tests/synthetic/verified_pairs.h"

namespace psfm {
namespace {

using test::SerialSession;

constexpr std::uint32_t kImages = 40;

/// Images arrive from the copied middle outwards, so that the fold is made before it can be known.
struct Streets {
    synthetic::SyntheticScene scene;
    std::vector<VerifiedPairPtr> pairs;

    Streets() {
        std::vector<std::size_t> order;
        for (std::size_t i = 0; i < kImages; ++i) order.push_back(i);
        std::ranges::stable_sort(
            order, {}, [](std::size_t image) { return std::max(image, kImages - 1 - image); });
        scene = synthetic::reorder_images(two_streets(kImages, 0.4, 2), order);
        pairs = synthetic::make_verified_pairs(scene);
        for (std::size_t place = 0; place < order.size(); ++place) {
            if (order[place] % 2 == 0) first_street.insert(static_cast<ImageId>(place));
        }
    }
    std::set<ImageId> first_street;
};

std::size_t count_of(const SerialSession& session, SessionEvent::Kind kind) {
    return static_cast<std::size_t>(
        std::ranges::count(session.events(), kind, &SessionEvent::kind));
}

/// Whether every effective cluster is of one street, and right.
void expect_streets_apart(const SerialSession& session, const Streets& streets) {
    EXPECT_EQ(session.state().counts.placed, kImages);
    EXPECT_EQ(session.state().counts.effective_clusters, 2U);
    for (const auto& cluster : session.state().scene->clusters) {
        std::size_t of_first = 0;
        for (const ImageId image : cluster->members)
            of_first += streets.first_street.contains(image) ? 1U : 0U;
        EXPECT_TRUE(of_first == 0 || of_first == cluster->members.size())
            << of_first << " of " << cluster->members.size();
        ASSERT_NE(cluster->model, nullptr);
        const auto error = synthetic::compare_with_truth(*cluster->model, streets.scene);
        ASSERT_TRUE(error.ok());
        EXPECT_LT(error->max_position, 0.01);
    }
    const std::vector<WeakModel> weak = weak_models(session.state());
    EXPECT_EQ(weak.size(), session.state().scene->clusters.size());
    for (const WeakModel& model : weak)
        EXPECT_TRUE(model.weaknesses.has(Weakness::kLookAlikes)) << "people are told";
}

TEST(Places, StreetsThatOneFacadeFoldedComeApart) {
    const Streets streets;
    const testing::TemporaryFolder folder;
    const auto store = test::open_store(folder);
    SerialSession session(*store, streets.scene, streets.pairs);
    const auto expect_told = [&] {
        const auto summary = decode_summary(*store->scene_summary_json());
        ASSERT_TRUE(summary.ok());
        EXPECT_EQ(summary->weak, weak_models(session.state())) << "of the version that says so";
    };
    for (std::uint32_t i = 0; i < kImages; ++i) {
        ASSERT_TRUE(session.add_image());
        expect_told();
        if (i == 7) {
            EXPECT_EQ(session.state().counts.effective_clusters, 1U)
                << "nothing tells them apart yet";
        }
    }
    session.end();
    expect_told();
    EXPECT_GE(count_of(session, SessionEvent::Kind::kPlaces), 1U);
    EXPECT_LE(count_of(session, SessionEvent::Kind::kPlaces), 3U);
    expect_streets_apart(session, streets);
}

TEST(Places, TooFewForAModelOfTheirOwnWaitAsLookAlikes) {
    const TwoParts parts;
    const testing::TemporaryFolder folder;
    const auto store = test::open_store(folder);
    const auto pairs = parts.pairs(0.7, 3);
    SerialSession session(*store, parts.scene, pairs, true, ClusteringOptions{}, {.mu_min = 5});
    while (session.reported().size() < TwoParts::kImages) ASSERT_TRUE(session.add_image());
    session.end();
    EXPECT_GE(session.state().counts.placed, TwoParts::kLeft);
    const auto waiting = waiting_images(session.state());
    EXPECT_EQ(waiting.size(), TwoParts::kImages - session.state().counts.placed);
    EXPECT_GE(waiting.size(), 3U);
    for (const auto& [image, reason] : waiting) EXPECT_EQ(reason, WaitReason::kLookAlikes);
    EXPECT_FALSE(weak_models(session.state()).empty()) << "people are told";
}

/// Two models that an edge joins once no image follows, and that have no place in each other.
TEST(Places, AModelThatAJoinLeavesOutStays) {
    const TwoModels parts;
    const testing::TemporaryFolder folder;
    const auto store = test::open_store(folder);
    SerialSession session(*store, parts.scene, parts.pairs, true, ClusteringOptions{});
    while (session.reported().size() < TwoModels::kImages) ASSERT_TRUE(session.add_image());
    session.end();
    EXPECT_EQ(count_of(session, SessionEvent::Kind::kPlaces), 1U);
    EXPECT_EQ(session.state().counts.placed, TwoModels::kFirst + TwoModels::kSecond);
    EXPECT_EQ(session.state().counts.effective_clusters, 2U);
    for (const auto& [id, entry] : session.state().clusters.entries())
        EXPECT_TRUE(entry.published.settled);
    const auto told =
        std::ranges::find(session.events(), SessionEvent::Kind::kPlaces, &SessionEvent::kind);
    ASSERT_NE(told, session.events().end());
    EXPECT_NE(told->text.find("makes 2 models, which nothing joins"), std::string::npos)
        << told->text;
}

TEST(Places, AreKnownToTheNextProcess) {
    const Streets streets;
    const testing::TemporaryFolder folder;
    std::vector<std::vector<ImageId>> apart;
    for (std::uint32_t i = 0; i < kImages; ++i) {
        const auto store = test::open_store(folder);
        SerialSession session(*store, streets.scene, streets.pairs);
        EXPECT_EQ(session.state().edges.apart.size(), i);
        if (i > 0) {
            EXPECT_EQ(session.state().edges.apart, apart) << "after image " << i;
        }
        ASSERT_TRUE(session.add_image());
        apart = session.state().edges.apart;
        if (i + 1 == kImages) {
            session.end();
            EXPECT_GT(session.state().edges.apart_count, 0U);
            expect_streets_apart(session, streets);
        }
        EXPECT_TRUE(store->check({})->damaged.empty());
    }
}

/// What a process would solve again that was killed after the first of several solutions.
TEST(Places, WhatOnesPlacesOvertookIsSolvedAgainFromWhatIsStored) {
    const Streets streets;
    const testing::TemporaryFolder folder;
    const auto store = test::open_store(folder);
    SerialSession session(*store, streets.scene, streets.pairs, true,
                          ClusteringOptions{.join_below = 0}, {.mu_min = 5});
    std::uint32_t next = 0;
    constexpr std::uint32_t kSettledApart = 16;  // images: by then none waits for its place
    while (next < kSettledApart || (session.state().edges.apart_count == 0 && next < kImages)) {
        ASSERT_TRUE(session.add_image());
        ++next;
    }
    const auto cluster_of = [&](std::uint32_t street_of) {
        const bool is_first = streets.first_street.contains(static_cast<ImageId>(street_of));
        for (const auto& [id, entry] : session.state().clusters.entries()) {
            if (entry.published.model &&
                streets.first_street.contains(entry.membership.members.front()) == is_first)
                return id;
        }
        return ClusterId{};
    };
    const auto is_one_then_two = [&](std::uint32_t image) {
        return cluster_of(image) < cluster_of(image + 1) &&
               cluster_of(image + 1) == cluster_of(image + 2);
    };
    for (; !is_one_then_two(next); ++next) {
        ASSERT_LT(next + 2, kImages);
        ASSERT_TRUE(session.add_image());
    }
    const ClusterId first = cluster_of(next);
    const ClusterId second = cluster_of(next + 1);
    session.hold_solves();
    for (int i = 0; i < 3; ++i) ASSERT_TRUE(session.add_image());
    ASSERT_EQ(session.held_solves(), 2U) << "one of each street, the second's is outgrown";
    const auto published = session.state().clusters.entries().at(second).published.model;
    session.release_showing_two_places(first);
    const auto again = std::ranges::find(
        session.held(), second, [](const SolveMessage& solve) { return solve.problem->cluster; });
    ASSERT_NE(again, session.held().end());
    ASSERT_EQ(again->problem->recycled.size(), 1U);
    EXPECT_EQ(again->problem->recycled.front(), published);
    // With them perhaps what the first one no longer wants.
    EXPECT_GE(again->problem->images.size(), published->images.size() + 2);
}

constexpr std::uint32_t kLargeFrom = 10;  // images that are not doubted as a whole any more

TEST(Places, OfLargeSessionsStayApartWhereTheyContradictEachOther) {
    const Streets streets;
    const testing::TemporaryFolder folder;
    const auto store = test::open_store(folder);
    SerialSession session(*store, streets.scene, streets.pairs, true, {.join_below = 0},
                          {.doubt_up_to = kLargeFrom});
    for (std::uint32_t i = 0; i < kImages; ++i) ASSERT_TRUE(session.add_image());
    session.end();
    EXPECT_GT(session.state().edges.apart_count, 0U);
    expect_streets_apart(session, streets);
}

/// One wall, whose last image brings a joint that shows two places.
class WronglyParted : public ::testing::Test {
  protected:
    WronglyParted() {
        synthetic::SceneOptions options = synthetic::line_along_wall(kImages);
        options.cameras.radius = 0.1 * kImages;  // steps of 20 cm
        options.points.extent.x() = 0.2 * kImages + 8.0;
        scene_ = synthetic::make_scene(options, 1);
        pairs_ = synthetic::make_verified_pairs(scene_);
        store_ = test::open_store(folder_);
        session_ = std::make_unique<SerialSession>(*store_, scene_, pairs_, true,
                                                   ClusteringOptions{.join_below = 0},
                                                   SolvePolicy{.doubt_up_to = kLargeFrom});
        for (std::uint32_t i = 0; i + 1 < kImages; ++i) EXPECT_TRUE(session_->add_image());
        session_->hold_solves();
        EXPECT_TRUE(session_->add_image());
        show_two_places(2);
        session_->release_solves();
        EXPECT_GT(apart(), 0U);
    }

    std::size_t apart() const { return session_->state().edges.apart_count; }
    void show_two_places(std::size_t parts) {
        ASSERT_EQ(session_->held_solves(), 1U);
        session_->release_showing_two_places(session_->held().front().problem->cluster, parts);
    }
    /// Until a model of all images is to be solved, but not settled, which is held.
    void solve_until_joined() {
        const auto is_joint = [](const SolveMessage& solve) {
            return solve.problem->images.size() == kImages && !solve.problem->settle;
        };
        while (session_->held_solves() > 0 && std::ranges::none_of(session_->held(), is_joint))
            session_->release_held();
    }
    void expect_one_part() const {
        EXPECT_EQ(apart(), 0U);
        EXPECT_EQ(session_->state().counts.placed, kImages);
        EXPECT_EQ(session_->state().counts.effective_clusters, 1U);
        EXPECT_TRUE(store_->check({})->damaged.empty());
    }

    testing::TemporaryFolder folder_;
    synthetic::SyntheticScene scene_;
    std::vector<VerifiedPairPtr> pairs_;
    std::unique_ptr<SessionStore> store_;
    std::unique_ptr<SerialSession> session_;
};

TEST_F(WronglyParted, JoinsAgainWhereTheyStandTogether) {
    session_->end();
    EXPECT_EQ(count_of(*session_, SessionEvent::Kind::kPlaces), 2U) << "told of both";
    expect_one_part();
}

TEST_F(WronglyParted, IsAskedAgainWhereFewerAreHeldApart) {
    const std::size_t before = apart();
    session_->hold_solves();
    session_->end();
    solve_until_joined();
    show_two_places(5);
    ASSERT_GT(apart(), 0U);
    ASSERT_LT(apart(), before);
    session_->release_solves();
    EXPECT_EQ(count_of(*session_, SessionEvent::Kind::kPlaces), 4U);
    expect_one_part();
}

TEST_F(WronglyParted, StaysSoWhereItIsPartedAgain) {
    const std::size_t before = apart();
    session_->hold_solves();
    session_->end();
    solve_until_joined();
    show_two_places(2);
    session_->release_solves();
    EXPECT_EQ(apart(), before);
    EXPECT_EQ(session_->state().counts.effective_clusters, 2U);
}

TEST(Places, SolutionsAreTakenInTheOrderOfTheirClusters) {
    const Streets streets;
    std::vector<std::vector<std::uint32_t>> orders;
    for (const bool last_first : {false, true}) {
        const testing::TemporaryFolder folder;
        const auto store = test::open_store(folder);
        SerialSession session(*store, streets.scene, streets.pairs);
        for (std::uint32_t i = 0; i < kImages; ++i) ASSERT_TRUE(session.add_image());
        session.hold_solves();
        session.end();
        ASSERT_EQ(session.held_solves(), 1U) << "all images are asked once more";
        while (session.held_solves() == 1) session.release_held();
        ASSERT_EQ(session.held_solves(), 2U) << "one of each street";
        const std::size_t before = session.events().size();
        session.release_solves(last_first);
        auto& clusters = orders.emplace_back();
        for (std::size_t i = before; i < session.events().size(); ++i) {
            const SessionEvent& event = session.events()[i];
            if (event.kind == SessionEvent::Kind::kSolve) clusters.push_back(event.clusters.at(0));
        }
        ASSERT_GE(clusters.size(), 2U);
        clusters.resize(2);  // those that were held
    }
    EXPECT_EQ(orders[0], orders[1]);
    EXPECT_TRUE(std::ranges::is_sorted(orders[0]));
}

}  // namespace
}  // namespace psfm
