// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/retrieval/expand_candidates.h"

#include <gtest/gtest.h>

#include <vector>

namespace psfm {
namespace {

constexpr std::uint32_t kImages = 20;

ViewGraph without_edges() {
    ViewGraph graph;
    for (std::uint32_t i = 0; i < kImages; ++i) graph.add_node();
    return graph;
}

/// Images 0 and 1 have edges with 10, 11 and 12, 0 a strong one with 11; image 5 has one with 15.
ViewGraph two_places() {
    ViewGraph graph = without_edges();
    const auto connect = [&](std::uint32_t a, std::uint32_t b, double weight) {
        graph.add_edge(static_cast<ImageId>(a), static_cast<ImageId>(b), weight);
    };
    connect(0, 10, 30.0);
    connect(0, 11, 300.0);
    connect(1, 10, 100.0);
    connect(1, 12, 100.0);
    connect(5, 15, 500.0);
    return graph;
}

const std::vector<ScoredImage> kSimilar{{0, 0.9F}, {1, 0.8F},  {2, 0.3F},
                                        {3, 0.2F}, {4, 0.15F}, {5, 0.1F}};

RetrievalOptions options_of(std::size_t candidates, std::size_t vouched) {
    RetrievalOptions options;
    options.candidates = candidates;
    options.vouched_part = static_cast<double>(vouched) / static_cast<double>(candidates);
    options.vouched_beyond = 0.0;
    return options;
}

std::vector<std::uint32_t> images_of(const std::vector<ScoredImage>& candidates) {
    std::vector<std::uint32_t> images;
    for (const ScoredImage& candidate : candidates) images.push_back(candidate.image);
    return images;
}

TEST(ExpandCandidates, NeighboursOfTheMostSimilarFollowThem) {
    const auto found = expand_candidates(kSimilar, two_places(), options_of(6, 4));
    // 10: 0.8 * 0.1 + 0.7; 11: 0.8; 12: 0.7; of the similar ones 2 with 0.2 is the best; the last
    // of them vouches for nobody.
    EXPECT_EQ(images_of(found), (std::vector<std::uint32_t>{0, 1, 11, 10, 12, 2}));
}

TEST(ExpandCandidates, ScoresFallAndSayThatAllWereCompared) {
    const auto found = expand_candidates(kSimilar, two_places(), options_of(6, 4));
    for (std::size_t i = 0; i + 1 < found.size(); ++i)
        EXPECT_GE(found[i].score, found[i + 1].score) << i;
    EXPECT_GT(found.back().score, 0.F);
    EXPECT_EQ(found.front().score, 0.9F);
}

TEST(ExpandCandidates, WithoutEdgesTheyAreTheMostSimilar) {
    for (const ViewGraph& graph : {ViewGraph(), without_edges()})
        EXPECT_EQ(images_of(expand_candidates(kSimilar, graph, options_of(5, 3))),
                  (std::vector<std::uint32_t>{0, 1, 2, 3, 4}));
}

TEST(ExpandCandidates, WeakEdgesVouchForNobody) {
    ViewGraph graph = without_edges();
    graph.add_edge(ImageId{0}, ImageId{10}, 0.0);
    EXPECT_EQ(images_of(expand_candidates(kSimilar, graph, options_of(4, 2))),
              (std::vector<std::uint32_t>{0, 1, 2, 3}));
}

TEST(ExpandCandidates, AsManyAsAskedForAreVouchedFor) {
    EXPECT_EQ(images_of(expand_candidates(kSimilar, two_places(), options_of(6, 0))),
              (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5}));
    EXPECT_EQ(images_of(expand_candidates(kSimilar, two_places(), options_of(6, 1))),
              (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 11}));
    EXPECT_EQ(expand_candidates(kSimilar, two_places(), options_of(3, 3)).size(), 3U);
    EXPECT_TRUE(expand_candidates({}, two_places(), options_of(3, 2)).empty());
}

TEST(ExpandCandidates, SimilarityIsEnoughInASmallCollection) {
    RetrievalOptions options = options_of(6, 2);
    options.vouched_beyond = 1.0;  // 6 of 20 images: 14 parts of 20 of the two
    EXPECT_EQ(images_of(expand_candidates(kSimilar, two_places(), options)),
              (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 11}));
    options.vouched_beyond = 10.0;
    EXPECT_EQ(images_of(expand_candidates(kSimilar, two_places(), options)),
              (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5}));
}

}  // namespace
}  // namespace psfm
