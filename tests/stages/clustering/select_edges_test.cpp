// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/clustering/select_edges.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <random>
#include <set>

#include "stages/clustering/keep_apart.h"

namespace psfm {
namespace {

using Pairs = std::vector<VerifiedPairPtr>;

VerifiedPairPtr make_pair(std::uint32_t a, std::uint32_t b, std::uint32_t inliers, double density,
                          double angle_deg) {
    auto pair = std::make_shared<VerifiedPair>();
    pair->pair = ImagePair::of(ImageId{a}, ImageId{b});
    for (std::uint32_t i = 0; i < inliers; ++i) pair->geometry.inliers.push_back({i, i});
    pair->geometry.match_density = density;
    pair->geometry.median_angle_deg = angle_deg;
    return pair;
}

/// Which pairs are edges once all images have arrived in the given order.
struct Session {
    EdgeSelection selection;
    ViewGraph graph;
    EdgeSelectionOptions options;

    EdgeChanges arrive(const Pairs& pairs) {
        return select_edges(selection, graph, static_cast<ImageId>(graph.size()), pairs, options);
    }
    bool has(std::uint32_t a, std::uint32_t b) const {
        const ViewGraph::Edge* edge = graph.find(ImageId{a}, ImageId{b});
        return edge != nullptr && edge->weight > 0.0;
    }
    bool has_weak(std::uint32_t a, std::uint32_t b) const {
        const ViewGraph::Edge* edge = graph.find(ImageId{a}, ImageId{b});
        return edge != nullptr && edge->weight == 0.0;
    }
};

TEST(SelectEdges, WeightsAreInliersFromTheBarOn) {
    Session session;
    session.arrive({});
    session.arrive({make_pair(0, 1, 29, 0.5, 1.0)});
    EXPECT_TRUE(session.has_weak(0, 1));
    session.arrive({make_pair(0, 2, 30, 0.5, 1.0), make_pair(1, 2, 1393, 0.5, 1.0)});
    ASSERT_TRUE(session.has(0, 2));
    EXPECT_EQ(session.graph.find(ImageId{0}, ImageId{2})->weight, 30.0);
    EXPECT_EQ(session.graph.find(ImageId{2}, ImageId{1})->weight, 1393.0);
}

TEST(SelectEdges, LookAlikeStaysWhileNothingBetterIsKnownAndGoesThen) {
    Session session;
    session.arrive({});
    session.arrive({make_pair(0, 1, 172, 0.03, 0.5)});  // looks alike, a sixth of a turn away
    EXPECT_TRUE(session.has(0, 1));
    // A true neighbour of 0 alone does not decide: 1 has nothing better yet.
    session.arrive({make_pair(0, 2, 1393, 0.4, 1.0)});
    EXPECT_TRUE(session.has(0, 1));
    const auto changed = session.arrive({make_pair(1, 3, 1393, 0.4, 1.0)});
    EXPECT_FALSE(session.has(0, 1));
    EXPECT_TRUE(session.has(0, 2));
    EXPECT_TRUE(session.has(1, 3));
    EXPECT_EQ(changed.images, (std::vector<ImageId>{ImageId{0}, ImageId{1}, ImageId{3}}));
    EXPECT_EQ(changed.removed, std::vector{ImagePair::of(ImageId{0}, ImageId{1})});
    EXPECT_TRUE(session.has_weak(0, 1)) << "it joins nothing, and models may still use it";
    EXPECT_EQ(session.graph.edge_count(), 3U);
}

TEST(SelectEdges, FromTheLowerBarOnPairsAreWeak) {
    Session session;
    session.arrive({});
    session.arrive({make_pair(0, 1, 14, 0.5, 1.0)});
    EXPECT_EQ(session.graph.edge_count(), 0U);
    session.arrive({make_pair(0, 2, 15, 0.5, 1.0)});
    EXPECT_TRUE(session.has_weak(0, 2));
    Session paper;
    paper.options.min_weak_inliers = 0;
    paper.arrive({});
    paper.arrive({make_pair(0, 1, 29, 0.5, 1.0)});
    EXPECT_EQ(paper.graph.edge_count(), 0U) << "there are no weak edges";
}

TEST(SelectEdges, NoWeakEdgeLeadsToAnotherPlace) {
    // 0 and 1 are known to be of different places; 2 has a good pair with 0 and a weak one with 1.
    Session session;
    session.arrive({});
    session.arrive({make_pair(0, 1, 100, 0.5, 1.0)});
    session.arrive({make_pair(0, 2, 100, 0.5, 1.0), make_pair(1, 2, 20, 0.5, 1.0)});
    ASSERT_TRUE(session.has_weak(1, 2));
    const PlaceVerdict verdict{{ImagePair::of(ImageId{0}, ImageId{1})}, {}};
    keep_apart(session.selection, session.graph, verdict);
    EXPECT_FALSE(session.has(0, 1) || session.has_weak(0, 1));
    EXPECT_TRUE(session.has(0, 2));
    EXPECT_FALSE(session.has_weak(1, 2));
    keep_apart(session.selection, session.graph, {{}, verdict.apart});  // taken back
    EXPECT_TRUE(session.has(0, 1));
    EXPECT_TRUE(session.has_weak(1, 2));
}

double plausibility_of(double density, double core, double angle_deg) {
    auto pair = *make_pair(0, 1, 50, density, angle_deg);
    pair.geometry.core_density = core;
    return plausibility(pair.geometry, {});
}

TEST(SelectEdges, WideBaselinesArePlausibleWithFewMatches) {
    EXPECT_GT(plausibility_of(0.03, 0.0, 30.0), 2.0);
    EXPECT_LT(plausibility_of(0.03, 0.0, 0.5), 0.3);
    EXPECT_GE(plausibility_of(0.01, 0.0, 90.0), 1.0);
}

TEST(SelectEdges, DenselyMatchedCoreIsPlausible) {
    // A walk down a street: its far end alone is shared, but there every other feature matches.
    EXPECT_GT(plausibility_of(0.01, 0.3, 0.5), 1.0);
    EXPECT_LT(plausibility_of(0.01, 0.04, 0.5), 0.2);
}

TEST(SelectEdges, PlausibilityIsBounded) {
    EXPECT_EQ(plausibility_of(1.0, 1.0, 10.0), PlausibilityOptions{}.max_plausibility);
    EXPECT_EQ(plausibility_of(0.0, 0.0, 1.0), PlausibilityOptions{}.max_plausibility)
        << "an unknown density casts no doubt";
}

TEST(SelectEdges, PaperTakesEveryPair) {
    Session session;
    session.options.min_relative_plausibility = 0.0;
    session.arrive({});
    session.arrive({make_pair(0, 1, 100, 0.001, 0.0)});
    session.arrive({make_pair(0, 2, 100, 0.9, 0.0), make_pair(1, 2, 100, 0.9, 0.0)});
    EXPECT_EQ(session.graph.edge_count(), 3U);
}

TEST(SelectEdges, RefusesSenselessOptions) {
    const auto refuses = [](const auto& change) {
        EdgeSelectionOptions options;
        change(options);
        return !validate(options).ok();
    };
    EXPECT_FALSE(refuses([](auto&) {}));
    EXPECT_TRUE(refuses([](auto& options) { options.min_inliers = 0; }));
    EXPECT_TRUE(refuses([](auto& options) { options.min_relative_plausibility = 1.1; }));
    EXPECT_TRUE(refuses([](auto& options) { options.plausibility.max_plausibility = 0.0; }));
    EXPECT_TRUE(refuses([](auto& options) { options.plausibility.shared.floor = 0.0; }));
    EXPECT_TRUE(refuses([](auto& options) { options.plausibility.core.decay_deg = 0.0; }));
}

/// Random pairs of images, by the images' true numbers.
Pairs random_pairs(std::uint32_t images, std::mt19937_64& rng) {
    Pairs pairs;
    std::uniform_real_distribution<double> unit;
    for (std::uint32_t b = 1; b < images; ++b) {
        for (std::uint32_t a = 0; a < b; ++a) {
            if (unit(rng) < 0.4)
                pairs.push_back(make_pair(a, b, static_cast<std::uint32_t>(20 + 30 * unit(rng)),
                                          0.3 * unit(rng) * unit(rng), 40.0 * unit(rng)));
        }
    }
    return pairs;
}

/// Edges by true numbers, when image order[i] is the i-th to arrive; checks what is reported.
std::set<ImagePair> edges_after(const Pairs& pairs, const std::vector<std::uint32_t>& order) {
    std::vector<std::uint32_t> rank(order.size());
    for (std::uint32_t i = 0; i < order.size(); ++i) rank[order[i]] = i;
    Session session;
    std::map<ImageId, std::size_t> degree;
    for (std::uint32_t i = 0; i < order.size(); ++i) {
        Pairs arriving;
        for (const VerifiedPairPtr& pair : pairs) {
            const std::uint32_t a = rank[index_of(pair->pair.first)];
            const std::uint32_t b = rank[index_of(pair->pair.second)];
            if (std::max(a, b) != i) continue;
            auto renamed = std::make_shared<VerifiedPair>(*pair);
            renamed->pair = ImagePair::of(ImageId{a}, ImageId{b});
            arriving.push_back(renamed);
        }
        const auto before = session.selection.edges;
        const auto changed = session.arrive(arriving);
        for (std::uint32_t image = 0; image < i; ++image) {
            const bool reported = std::ranges::binary_search(changed.images, ImageId{image});
            if (before[image].size() != session.selection.edges[image].size()) {
                EXPECT_TRUE(reported) << image;
            }
        }
    }
    std::set<ImagePair> edges;
    for (std::uint32_t i = 0; i < order.size(); ++i) {
        for (const ViewGraph::Edge& edge : session.graph.edges(ImageId{i}))
            edges.insert(ImagePair::of(ImageId{order[i]}, ImageId{order[index_of(edge.neighbor)]}));
    }
    EXPECT_EQ(edges.size(), session.graph.edge_count());
    return edges;
}

TEST(SelectEdges, DependOnTheSetOfImagesNotOnTheirOrder) {
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        std::mt19937_64 rng(seed);
        const auto images = static_cast<std::uint32_t>(3 + rng() % 12);
        const Pairs pairs = random_pairs(images, rng);
        std::vector<std::uint32_t> order(images);
        std::iota(order.begin(), order.end(), 0U);
        const auto expected = edges_after(pairs, order);
        for (int shuffle = 0; shuffle < 4; ++shuffle) {
            std::ranges::shuffle(order, rng);
            EXPECT_EQ(edges_after(pairs, order), expected) << "seed " << seed;
        }
    }
}

}  // namespace
}  // namespace psfm
