// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/clustering/still_features.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <optional>

#include "stages/clustering/select_edges.h"

namespace psfm {
namespace {

struct Features {
    std::uint32_t first = 0;
    std::uint32_t count = 0;
};

/// Features are numbered alike in all images: i matches i.
std::vector<FeatureMatch> matches_of(std::initializer_list<Features> ranges) {
    std::vector<FeatureMatch> matches;
    for (const Features& range : ranges) {
        for (std::uint32_t i = range.first; i < range.first + range.count; ++i)
            matches.push_back({i, i});
    }
    return matches;
}

VerifiedPairPtr make_pair(std::uint32_t a, std::uint32_t b, std::vector<FeatureMatch> inliers,
                          std::vector<FeatureMatch> still) {
    auto pair = std::make_shared<VerifiedPair>();
    pair->pair = ImagePair::of(ImageId{a}, ImageId{b});
    pair->geometry.inliers = std::move(inliers);
    pair->geometry.still = std::move(still);
    pair->geometry.match_density = 0.3;
    return pair;
}

constexpr Features kHood{1000, 200};
constexpr Features kScene{0, 300};

VerifiedPairPtr hood_seen(std::uint32_t a, std::uint32_t b) {
    return make_pair(a, b, matches_of({kScene}), matches_of({kHood}));
}
/// The camera did not turn, so that the hood passes for something far away.
VerifiedPairPtr hood_taken_for_far(std::uint32_t a, std::uint32_t b) {
    return make_pair(a, b, matches_of({{0, 250}, kHood}), matches_of({kHood}));
}
/// Nothing but the hood agrees.
VerifiedPairPtr hood_alone(std::uint32_t a, std::uint32_t b) {
    return make_pair(a, b, matches_of({kHood}), matches_of({kHood}));
}

TEST(StillFeatures, TakeTwoPairsInWhichTheSceneMoves) {
    const ImageId image{0};
    const std::vector<VerifiedPairPtr> one{hood_seen(0, 1), hood_alone(0, 2),
                                           hood_taken_for_far(0, 3)};
    EXPECT_TRUE(still_features(image, one, {}).empty());
    std::vector<VerifiedPairPtr> two{hood_seen(0, 1), hood_seen(0, 2), hood_alone(0, 3)};
    const auto features = still_features(image, two, {});
    ASSERT_EQ(features.size(), 200U);
    EXPECT_EQ(features.front(), 1000U);
    EXPECT_EQ(features.back(), 1199U);
    std::ranges::reverse(two);
    EXPECT_EQ(still_features(image, two, {}), features);
    EXPECT_TRUE(still_features(image, two, {.min_pairs = 0}).empty());
}

TEST(StillFeatures, WhatMovesWithTheSceneElsewhereIsOfTheScene) {
    // A tripod before which somebody walked, and photographs from elsewhere.
    const std::vector<VerifiedPairPtr> pairs{hood_seen(0, 1), hood_seen(0, 2),
                                             make_pair(0, 3, matches_of({kScene, kHood}), {}),
                                             make_pair(0, 4, matches_of({kScene, kHood}), {})};
    EXPECT_TRUE(still_features(ImageId{0}, pairs, {}).empty());
}

TEST(StillFeatures, LeaveThePairWithoutThem) {
    std::vector<std::uint32_t> hood(200);
    std::iota(hood.begin(), hood.end(), 1000U);
    const auto far = hood_taken_for_far(0, 1);
    for (const bool in_first : {true, false}) {
        const std::vector<std::uint32_t> none;
        const auto trimmed = without_still(far, in_first ? hood : none, in_first ? none : hood, {});
        ASSERT_TRUE(trimmed);
        EXPECT_EQ(trimmed->geometry.inliers, matches_of({{0, 250}}));
    }
    EXPECT_EQ(without_still(far, {}, {}, {}), far);
    const auto seen = hood_seen(0, 1);
    EXPECT_EQ(without_still(seen, hood, hood, {}), seen);
    EXPECT_EQ(without_still(hood_alone(0, 1), hood, {}, {}), nullptr);
}

/// A session of images of which each pair is as given.
struct Session {
    EdgeSelection selection;
    ViewGraph graph;
    std::map<ImagePair, VerifiedPairPtr> edges() const {
        std::map<ImagePair, VerifiedPairPtr> all;
        for (std::uint32_t i = 0; i < graph.size(); ++i) {
            for (const ViewGraph::Edge& edge : graph.edges(ImageId{i})) {
                all[edge.pair->pair] = edge.pair;
                EXPECT_EQ(edge.weight, static_cast<double>(edge.pair->geometry.inliers.size()));
            }
        }
        return all;
    }
};

TEST(SelectEdges, PairsThatRestOnTheHoodGoWhenItIsKnownInAnyOrder) {
    // 0-1-2-3 are neighbours; 0 and 3 have the hood in common, 1 and 3 were taken without a turn.
    const auto kind_of = [](std::uint32_t a, std::uint32_t b) -> VerifiedPairPtr {
        if (b - a == 3) return hood_alone(a, b);
        return a == 1 && b == 3 ? hood_taken_for_far(a, b) : hood_seen(a, b);
    };
    std::vector<std::uint32_t> order{0, 1, 2, 3};
    do {
        Session session;
        for (std::uint32_t i = 0; i < order.size(); ++i) {
            std::vector<VerifiedPairPtr> pairs;
            for (std::uint32_t j = 0; j < i; ++j) {
                auto pair = std::make_shared<VerifiedPair>(
                    *kind_of(std::min(order[i], order[j]), std::max(order[i], order[j])));
                pair->pair = {ImageId{j}, ImageId{i}};
                pairs.push_back(std::move(pair));
            }
            select_edges(session.selection, session.graph, ImageId{i}, pairs, {});
        }
        EXPECT_EQ(session.graph.edge_count(), 5U);
        for (const auto& [pair, edge] : session.edges()) {
            const std::uint32_t a = order[index_of(pair.first)];
            const std::uint32_t b = order[index_of(pair.second)];
            EXPECT_NE(a + b == 3 && (a == 0 || b == 0), true) << a << ' ' << b;
            const bool far = a + b == 4;
            EXPECT_EQ(edge->geometry.inliers, matches_of({far ? Features{0, 250} : kScene}));
        }
    } while (std::ranges::next_permutation(order).found);
}

TEST(SelectEdges, StillOnlyIsNoEdgeAndIsCounted) {
    Session session;
    select_edges(session.selection, session.graph, ImageId{0}, {}, {});
    const std::vector<VerifiedPairPtr> pairs{make_pair(0, 1, {}, matches_of({kHood}))};
    select_edges(session.selection, session.graph, ImageId{1}, pairs, {});
    EXPECT_EQ(session.graph.edge_count(), 0U);
    EXPECT_EQ(session.selection.still_only, (std::vector<std::uint32_t>{1, 1}));
}

TEST(SelectEdges, WhatStoodStillDoesNotOutdoWhatMoved) {
    // Two photographs from one place match in most of their features, those from two in few.
    Session session;
    for (std::uint32_t i = 0; i < 4; ++i) {
        std::vector<VerifiedPairPtr> pairs;
        for (std::uint32_t j = 0; j < i; ++j) {
            const bool burst = i / 2 == j / 2;
            auto pair = std::make_shared<VerifiedPair>(
                burst ? *hood_alone(j, i) : *make_pair(j, i, matches_of({kScene}), {}));
            pair->geometry.match_density = burst ? 0.9 : 0.05;
            pairs.push_back(std::move(pair));
        }
        select_edges(session.selection, session.graph, ImageId{i}, pairs, {});
    }
    EXPECT_EQ(session.graph.edge_count(), 6U);
}

}  // namespace
}  // namespace psfm
