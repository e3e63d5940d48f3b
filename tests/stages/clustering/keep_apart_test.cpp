// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/clustering/keep_apart.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "stages/clustering/apply_selection.h"

namespace psfm {
namespace {

using Pairs = std::vector<VerifiedPairPtr>;

VerifiedPairPtr make_pair(std::uint32_t a, std::uint32_t b, std::uint32_t inliers) {
    auto pair = std::make_shared<VerifiedPair>();
    pair->pair = ImagePair::of(ImageId{a}, ImageId{b});
    for (std::uint32_t i = 0; i < inliers; ++i) pair->geometry.inliers.push_back({i, i});
    return pair;
}

ImagePair ids(std::uint32_t a, std::uint32_t b) {
    return ImagePair::of(ImageId{a}, ImageId{b});
}

struct Session {
    EdgeSelection selection;
    ViewGraph graph;

    EdgeChanges arrive(const Pairs& pairs) {
        return select_edges(selection, graph, static_cast<ImageId>(graph.size()), pairs, {});
    }
    bool has(std::uint32_t a, std::uint32_t b) const {
        return graph.find(ImageId{a}, ImageId{b}) != nullptr;
    }
};

/// Images 0, 1 of one street and 2, 3 of another one, every two of them a pair.
Session two_streets() {
    Session session;
    session.arrive({});
    session.arrive({make_pair(0, 1, 200)});
    session.arrive({make_pair(0, 2, 100), make_pair(1, 2, 100)});
    session.arrive({make_pair(0, 3, 100), make_pair(1, 3, 100), make_pair(2, 3, 200)});
    return session;
}

const PlaceVerdict kTwoStreets{{ids(0, 2), ids(0, 3), ids(1, 2), ids(1, 3)}, {}};

TEST(KeepApart, TakesEdgesOutAndBackAgain) {
    Session session = two_streets();
    const EdgeChanges apart = keep_apart(session.selection, session.graph, kTwoStreets);
    EXPECT_EQ(apart.removed, kTwoStreets.apart);
    EXPECT_EQ(apart.images.size(), 4U);
    EXPECT_EQ(session.graph.edge_count(), 2U);
    EXPECT_TRUE(session.has(0, 1));
    EXPECT_TRUE(session.has(2, 3));
    const std::vector<ImageId> first_street{ImageId{0}, ImageId{1}};
    EXPECT_EQ(apart_pairs_of(session.selection, first_street), kTwoStreets.apart);

    const EdgeChanges back = keep_apart(session.selection, session.graph, {{}, kTwoStreets.apart});
    EXPECT_TRUE(back.removed.empty());
    EXPECT_EQ(back.images.size(), 4U);
    EXPECT_EQ(session.graph.edge_count(), 6U);
    EXPECT_EQ(session.graph.find(ImageId{0}, ImageId{2})->weight, 100.0);
    EXPECT_EQ(session.selection.apart_count, 0U);
}

TEST(KeepApart, ANewImageIsOfTheStreetThatItSharesMoreWith) {
    Session session = two_streets();
    keep_apart(session.selection, session.graph, kTwoStreets);
    session.arrive(
        {make_pair(0, 4, 100), make_pair(1, 4, 100), make_pair(2, 4, 150), make_pair(3, 4, 60)});
    EXPECT_FALSE(session.has(0, 4));
    EXPECT_FALSE(session.has(1, 4));
    EXPECT_TRUE(session.has(2, 4));
    EXPECT_TRUE(session.has(3, 4));
    // A model finds that it was the wrong one: the others are its edges now.
    const EdgeChanges changes =
        keep_apart(session.selection, session.graph, {{ids(2, 4), ids(3, 4)}, {}});
    EXPECT_EQ(changes.removed, (std::vector{ids(2, 4), ids(3, 4)}));
    EXPECT_TRUE(session.has(0, 4));
    EXPECT_TRUE(session.has(1, 4));
}

TEST(KeepApart, AnImageOfBothStreetsKeepsThemWhileNothingOpposes) {
    Session session = two_streets();
    session.arrive({make_pair(0, 4, 100), make_pair(2, 4, 100)});
    EXPECT_TRUE(session.has(0, 4));
    EXPECT_TRUE(session.has(2, 4));
    const EdgeChanges changes = keep_apart(session.selection, session.graph, kTwoStreets);
    EXPECT_TRUE(session.has(0, 4)) << "equally strong: a corner, perhaps";
    EXPECT_TRUE(session.has(2, 4));
    EXPECT_EQ(changes.images.size(), 4U);
}

TEST(KeepApart, JudgesPairsOfTheModelOnly) {
    Session session = two_streets();
    const std::vector<ImageId> model{ImageId{0}, ImageId{1}, ImageId{3}};
    const std::vector<std::vector<ImageId>> places{{ImageId{0}, ImageId{1}}, {ImageId{3}}};
    const PlaceVerdict apart = judge_places(session.selection, model, places);
    EXPECT_EQ(apart.apart, (std::vector{ids(0, 3), ids(1, 3)}));
    EXPECT_TRUE(apart.together.empty());
    keep_apart(session.selection, session.graph, apart);
    EXPECT_TRUE(judge_places(session.selection, model, places).empty()) << "known already";
    const PlaceVerdict together = judge_places(session.selection, model, {});
    EXPECT_TRUE(together.apart.empty());
    EXPECT_EQ(together.together, apart.apart);
    const std::vector<std::vector<ImageId>> others{{ImageId{0}}, {ImageId{1}}};
    const PlaceVerdict partly = judge_places(session.selection, model, others);
    EXPECT_EQ(partly.apart, std::vector{ids(0, 1)});
    EXPECT_TRUE(partly.together.empty()) << "image 3 is of any place";
}

TEST(KeepApart, WhoIsLeftAloneWasApartBefore) {
    Session session = two_streets();
    session.arrive({make_pair(0, 4, 100), make_pair(1, 4, 100), make_pair(2, 4, 100)});
    const std::vector<ImageId> first{ImageId{0}, ImageId{1}, ImageId{4}};
    keep_apart(session.selection, session.graph,
               {{ids(0, 2), ids(0, 3), ids(1, 2), ids(1, 3), ids(2, 4)}, {}});
    const std::vector<std::vector<ImageId>> places{{ImageId{0}, ImageId{1}}, {ImageId{4}}};
    EXPECT_EQ(apart_before(session.selection, first, places, 2), std::vector{ids(2, 4)});
    EXPECT_TRUE(apart_before(session.selection, first, places, 1).empty()) << "makes a model";
    EXPECT_EQ(apart_before(session.selection, first, places, 3).size(), 5U);
    const std::vector<ImageId> all{ImageId{0}, ImageId{1}, ImageId{2}, ImageId{3}, ImageId{4}};
    EXPECT_TRUE(apart_before(session.selection, all, places, 2).empty())
        << "this model says it of images that it shows";
}

/// What a process knows that reads the same images back, and then which of them are apart.
Session restored(const std::vector<Pairs>& arrivals, const std::vector<ImagePair>& apart) {
    Session session;
    for (const Pairs& pairs : arrivals) session.arrive(pairs);
    keep_apart(session.selection, session.graph, {apart, {}});
    return session;
}

TEST(KeepApart, ClustersHangTogetherByAPairThatIsAboutTheBestOfOneOfItsImages) {
    Session session = two_streets();
    keep_apart(session.selection, session.graph, kTwoStreets);
    ClusteringState clustering;
    clustering.cluster_of = {ClusterId{0}, ClusterId{0}, ClusterId{1}, ClusterId{1}};
    clustering.members = {{ClusterId{0}, {ImageId{0}, ImageId{1}}},
                          {ClusterId{1}, {ImageId{2}, ImageId{3}}}};
    const auto hang = [&](double min_relative) {
        return hang_together(clustering, session.selection, ClusterId{0}, ClusterId{1},
                             min_relative);
    };
    EXPECT_TRUE(hang(0.4)) << "100 matches where the best have 200";
    EXPECT_FALSE(hang(0.6));
    // An image of the first street, by its cluster, whose best pair is one with the second.
    session.arrive({make_pair(0, 4, 60), make_pair(3, 4, 150)});
    clustering.cluster_of.push_back(ClusterId{0});
    clustering.members[ClusterId{0}].push_back(ImageId{4});
    EXPECT_TRUE(hang(0.9)) << "whether it is an edge at present or not";
}

TEST(KeepApart, DependsOnWhatIsKnownNotOnWhenItBecameKnown) {
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
        std::mt19937_64 rng(seed);
        Session session;
        std::vector<Pairs> arrivals;
        std::set<ImagePair> apart;
        const auto images = static_cast<std::uint32_t>(3 + rng() % 14);
        for (std::uint32_t b = 0; b < images; ++b) {
            Pairs pairs;
            for (std::uint32_t a = 0; a < b; ++a) {
                if (rng() % 2 == 0) {
                    auto pair = make_pair(a, b, static_cast<std::uint32_t>(20 + rng() % 100));
                    pairs.push_back(pair);
                }
            }
            session.arrive(pairs);
            arrivals.push_back(pairs);
            PlaceVerdict verdict;
            for (const Pairs& earlier : arrivals) {
                for (const VerifiedPairPtr& pair : earlier) {
                    if (rng() % 12 != 0) continue;
                    const bool was_apart = apart.contains(pair->pair);
                    (was_apart ? verdict.together : verdict.apart).push_back(pair->pair);
                    was_apart ? void(apart.erase(pair->pair)) : void(apart.insert(pair->pair));
                }
            }
            keep_apart(session.selection, session.graph, verdict);
        }
        const Session again = restored(arrivals, {apart.begin(), apart.end()});
        EXPECT_EQ(session.selection.apart_count, apart.size());
        ASSERT_EQ(session.graph.edge_count(), again.graph.edge_count()) << "seed " << seed;
        for (std::uint32_t i = 0; i < images; ++i) {
            EXPECT_EQ(session.selection.outvoted[i],
                      outvoted_neighbors(session.selection, ImageId{i}));
            const auto live = session.graph.edges(ImageId{i});
            const auto known = again.graph.edges(ImageId{i});
            ASSERT_TRUE(std::ranges::equal(live, known, {}, &ViewGraph::Edge::neighbor,
                                           &ViewGraph::Edge::neighbor))
                << "seed " << seed;
        }
    }
}

}  // namespace
}  // namespace psfm
