// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/checks/separate_places.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>

#include "stages/algorithms/math/contract_signed_graph.h"
#include "stages/reconstruction/checks/side_by_side.h"
#include "tests/stages/reconstruction/two_streets.h"
#include "tests/synthetic/verified_pairs.h"

namespace psfm {
namespace {

using synthetic::SyntheticScene;
using Places = std::vector<std::vector<ImageId>>;

constexpr std::uint32_t kImages = 40;

Places places_of(const SyntheticScene& scene, const PlaceOptions& options = {}) {
    return separate_places(synthetic::true_reconstruction(scene, synthetic::random_gauge(3)),
                           synthetic::make_verified_pairs(scene), options);
}

std::vector<ImageId> every_second(std::uint32_t first) {
    std::vector<ImageId> images;
    for (std::uint32_t i = first; i < kImages; i += 2) images.push_back(ImageId{i});
    return images;
}

/// Images that stand in a place of more images of the other street.
std::ptrdiff_t misplaced(const Places& places) {
    std::ptrdiff_t sum = 0;
    for (const std::vector<ImageId>& place : places) {
        const auto of_second =
            std::ranges::count_if(place, [](ImageId image) { return index_of(image) % 2 == 1; });
        sum += std::min(of_second, std::ssize(place) - of_second);
    }
    return sum;
}

TEST(SeparatePlaces, OneStreetIsOnePlace) {
    EXPECT_TRUE(places_of(synthetic::make_scene(synthetic::line_along_wall(kImages), 1)).empty());
    EXPECT_TRUE(places_of(synthetic::make_scene(synthetic::ring_in_room(kImages), 1)).empty());
}

TEST(SeparatePlaces, StreetsThatOneFacadeFoldsAreTwo) {
    for (const double copied : {0.2, 0.4, 0.6}) {
        const SyntheticScene scene = two_streets(kImages, copied, 2);
        const auto pairs = synthetic::make_verified_pairs(scene);
        const auto across = std::ranges::count_if(pairs, [](const VerifiedPairPtr& pair) {
            return (index_of(pair->pair.first) + index_of(pair->pair.second)) % 2 == 1;
        });
        ASSERT_GT(across, 10) << "wrong edges hold the model together";
        EXPECT_EQ(places_of(scene), (Places{every_second(0), every_second(1)})) << copied;
    }
}

TEST(SeparatePlaces, WhatWasCopiedWholeIsSeenFromBothSides) {
    // Every image has half of what it should share with those beside it: too much for strangers.
    const SyntheticScene scene = two_streets(kImages, 1.2, 2);
    const Places places = places_of(scene);
    EXPECT_EQ(places.size(), 2U);
    EXPECT_LE(misplaced(places), 6) << "at the ends nothing is seen from both sides";
    PlaceOptions side_by_side_alone;
    side_by_side_alone.folded_between = 0.0;
    EXPECT_TRUE(places_of(scene, side_by_side_alone).empty());
}

TEST(SeparatePlaces, StreetsWhereNobodyStandsBesideAnybodyAreTwo) {
    // Who walks along the second one stands farther from the wall.
    const SyntheticScene scene = two_streets(kImages, 0.6, 2);
    Reconstruction model = synthetic::true_reconstruction(scene);
    for (RegisteredImage& image : model.images) {
        if (index_of(image.image) % 2 == 1) image.cam_from_cluster.translation.z() += 3.0;
    }
    PlaceOptions options;
    options.between.size_slack = 0.4;  // all of one street are nearer than all of the other
    const auto pairs = synthetic::make_verified_pairs(scene);
    const Places places = separate_places(model, pairs, options);
    EXPECT_EQ(places.size(), 2U);
    EXPECT_LE(misplaced(places), 3);
    options.folded_between = 0.0;
    EXPECT_TRUE(separate_places(model, pairs, options).empty());
}

TEST(SeparatePlaces, APlaceHoldsTogetherByItself) {
    const SyntheticScene scene = two_streets(kImages, 1.2, 2);
    const Reconstruction model = synthetic::true_reconstruction(scene);
    auto pairs = synthetic::make_verified_pairs(scene);
    PlaceOptions options;
    options.min_within = 0.3;
    EXPECT_EQ(separate_places(model, pairs, options).size(), 2U);
    // Of the second street, only images that follow each other have a pair.
    std::erase_if(pairs, [](const VerifiedPairPtr& pair) {
        const std::uint32_t first = index_of(pair->pair.first);
        const std::uint32_t second = index_of(pair->pair.second);
        return first % 2 == 1 && second % 2 == 1 && second - first > 2;
    });
    EXPECT_TRUE(separate_places(model, pairs, options).empty());
    options.min_within = 0.0;
    EXPECT_EQ(separate_places(model, pairs, options).size(), 2U);
}

TEST(SeparatePlaces, FewContradictionsAreNoFold) {
    const SyntheticScene scene = two_streets(kImages, 0.4, 2);
    PlaceOptions options;
    options.min_contradictions = 1000;
    EXPECT_TRUE(places_of(scene, options).empty());
    options.min_contradictions = 0;
    EXPECT_TRUE(places_of(scene, options).empty()) << "switched off";
}

TEST(SeparatePlaces, AFewImagesAreNoPlace) {
    const SyntheticScene scene = two_streets(kImages, 0.4, 2);
    PlaceOptions options;
    options.min_images = kImages / 2;
    EXPECT_EQ(places_of(scene, options).size(), 2U);
    options.min_images = kImages / 2 + 1;
    EXPECT_TRUE(places_of(scene, options).empty()) << "they have wrong poses";
}

TEST(SideBySide, CountsWhatImagesShareAndShould) {
    const SyntheticScene scene = two_streets(kImages, 0.1, 4);
    const Reconstruction model = synthetic::true_reconstruction(scene, synthetic::random_gauge(5));
    const auto pairs = find_side_by_side(model, {});
    ASSERT_GT(pairs.size(), kImages);
    EXPECT_TRUE(std::ranges::is_sorted(
        pairs, {}, [](const SideBySide& pair) { return std::pair(pair.first, pair.second); }));
    for (const SideBySide& pair : pairs) {
        EXPECT_LT(pair.first, pair.second);
        EXPECT_LE(pair.second - pair.first, 4U) << "steps of half a metre, and their spread";
        EXPECT_LE(pair.shared, pair.expected);
        const bool one_street = (pair.second - pair.first) % 2 == 0;
        const bool at_an_end = pair.second < 5 || pair.first >= kImages - 5;
        if (one_street) {
            EXPECT_GT(pair.shared_part(), 0.95);
        } else if (at_an_end) {
            EXPECT_EQ(pair.shared, 0U);
        }
    }
}

TEST(SideBySide, AFewPointsOfEachImageSayNearlyTheSame) {
    const SyntheticScene scene = two_streets(kImages, 0.1, 4);
    const Reconstruction model = synthetic::true_reconstruction(scene, {});
    constexpr std::uint32_t kFew = 30;
    const auto all = find_side_by_side(model, {});
    const auto glance = find_side_by_side(model, {}, kFew);
    // The depth of what an image sees, and with it who stands beside it, is a little different.
    std::size_t found = 0;
    for (const SideBySide& pair : all) {
        const auto same = std::ranges::find_if(glance, [&](const SideBySide& other) {
            return other.first == pair.first && other.second == pair.second;
        });
        if (same == glance.end()) continue;
        ++found;
        EXPECT_NEAR(same->expected, pair.expected, 0.5 * pair.expected)
            << "a point counts for several";
        EXPECT_NEAR(same->shared_part(), pair.shared_part(), 0.1);
    }
    EXPECT_GT(found, all.size() * 9 / 10);
    EXPECT_LT(glance.size(), all.size() * 11 / 10);
    EXPECT_EQ(find_side_by_side(model, {}, 1000000).size(), all.size()) << "of all points";
    const auto counted = count_all_points(model, {}, glance);
    EXPECT_EQ(counted.size(), glance.size());
    for (const SideBySide& pair : counted) {
        const auto same = std::ranges::find_if(all, [&](const SideBySide& other) {
            return other.first == pair.first && other.second == pair.second;
        });
        if (same == all.end()) continue;
        EXPECT_EQ(pair.expected, same->expected);
        EXPECT_EQ(pair.shared, same->shared);
    }
}

TEST(SideBySide, LeavesOutImagesThatLookElsewhereAndPointsOfFew) {
    const SyntheticScene scene = two_streets(8, 1.2, 4);
    const Reconstruction model = synthetic::true_reconstruction(scene, {});
    PlaceOptions options;
    ASSERT_FALSE(find_side_by_side(model, options).empty());
    options.min_track = 9;
    EXPECT_TRUE(find_side_by_side(model, options).empty()) << "nobody expects anything";
    options.min_track = 3;
    options.max_neighbors = 1;
    const auto nearest = find_side_by_side(model, options);
    EXPECT_LE(nearest.size(), 8U);
    options.max_neighbors = 24;
    options.max_turn_deg = 0.001;
    EXPECT_TRUE(find_side_by_side(model, options).empty()) << "all are turned a little";
    EXPECT_TRUE(find_side_by_side(Reconstruction{}, {}).empty());
}

TEST(ContractSignedGraph, JoinsWhatMoreSpeaksForThanAgainst) {
    // Two triangles, a wrong edge between them, and two contradictions.
    const std::vector<SignedEdge> edges{{0, 1, 1.0}, {1, 2, 1.0},  {0, 2, 1.0},
                                        {3, 4, 1.0}, {4, 5, 1.0},  {3, 5, 1.0},
                                        {2, 3, 0.5}, {0, 5, -0.3}, {1, 4, -0.3}};
    EXPECT_EQ(contract_signed_graph(7, edges), (std::vector<std::uint32_t>{0, 0, 0, 1, 1, 1, 2}));
    auto weaker = edges;
    weaker.back().weight = -0.1;
    EXPECT_EQ(contract_signed_graph(7, weaker), (std::vector<std::uint32_t>{0, 0, 0, 0, 0, 0, 1}));
    EXPECT_TRUE(contract_signed_graph(0, {}).empty());
}

TEST(ContractSignedGraph, NothingSpeaksForJoiningTheParts) {
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
        std::mt19937_64 rng(seed);
        const auto nodes = static_cast<std::uint32_t>(2 + rng() % 30);
        std::vector<SignedEdge> edges;
        for (std::uint32_t a = 0; a < nodes; ++a) {
            for (std::uint32_t b = a + 1; b < nodes; ++b) {
                if (rng() % 3 == 0)
                    edges.push_back({a, b, static_cast<double>(rng() % 201) / 100.0 - 1.0});
            }
        }
        const auto part = contract_signed_graph(nodes, edges);
        std::map<std::pair<std::uint32_t, std::uint32_t>, double> between;
        for (const SignedEdge& edge : edges) {
            const auto [low, high] = std::minmax(part[edge.first], part[edge.second]);
            if (low != high) between[{low, high}] += edge.weight;
        }
        for (const auto& [parts, weight] : between) EXPECT_LE(weight, 1e-9) << "seed " << seed;
        std::shuffle(edges.begin(), edges.end(), rng);
        EXPECT_EQ(contract_signed_graph(nodes, edges), part) << "in any order of the edges";
    }
}

}  // namespace
}  // namespace psfm
