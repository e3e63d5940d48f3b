// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/checks/rival_models.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/stages/reconstruction/two_parts.h"

namespace psfm {
namespace {

using Edges = std::set<ImagePair>;

/// A model of two parts, as it is judged. All edges are as good as each other.
/// @param denied  these edges; it explains all others
Judged judged(const TwoParts& parts, const Edges& denied) {
    Judged model;
    model.attempt.model = synthetic::true_reconstruction(parts.scene, Sim3{});
    model.attempt.places.emplace();
    model.score = {.images = TwoParts::kImages, .observations = 1000, .regions = 100};
    for (const VerifiedPairPtr& pair : parts.pairs(1.0, 1)) {
        const double explained = denied.contains(pair->pair) ? 0.0 : 1.0;
        model.edges.push_back({static_cast<std::uint32_t>(index_of(pair->pair.first)),
                               static_cast<std::uint32_t>(index_of(pair->pair.second)), pair,
                               explained, 1.0, 1.0, false});
    }
    return model;
}

/// Of the parts, one edge joins the nearest images and another one the farthest.
const ImagePair kNear{ImageId{TwoParts::kLeft - 1}, ImageId{TwoParts::kLeft}};
const ImagePair kFar{ImageId{0}, ImageId{TwoParts::kImages - 1}};

OtherModel other(const Judged& model) {
    return {model.score, model.edges};
}

TEST(RivalModels, WhatTheyDoNotShowAlikeIsKeptApart) {
    const TwoParts scene;
    const Judged best = judged(scene, {kFar});
    const OtherModel rival = other(judged(scene, {kNear}));
    const auto parts = parts_in_common(best, {{other(best), rival}}, {});
    ASSERT_EQ(parts.size(), 2U);
    EXPECT_EQ(parts.front().size(), TwoParts::kLeft);
    EXPECT_EQ(parts.back().front(), ImageId{TwoParts::kLeft});
    EXPECT_EQ(parts.back().size(), TwoParts::kImages - TwoParts::kLeft);
}

TEST(RivalModels, AreAboutAsGoodAndOfTheSameImages) {
    const TwoParts scene;
    const Judged best = judged(scene, {kFar});
    const auto splits = [&](const OtherModel& rival) {
        return !parts_in_common(best, {&rival, 1}, {}).empty();
    };
    const OtherModel rival = other(judged(scene, {kNear}));
    ASSERT_TRUE(splits(rival));
    OtherModel explains_less = rival;
    explains_less.score.observations = 970;
    EXPECT_FALSE(splits(explains_less));
    OtherModel misses = rival;
    misses.score.missing = 20;
    EXPECT_FALSE(splits(misses));
    OtherModel is_smaller = rival;
    is_smaller.edges.pop_back();
    EXPECT_FALSE(splits(is_smaller));
}

TEST(RivalModels, ExplainWhatTheModelDeniesAndTheOtherWayRound) {
    const TwoParts scene;
    const Judged best = judged(scene, {kFar});
    const OtherModel explains_all = other(judged(scene, {}));
    EXPECT_TRUE(parts_in_common(best, {&explains_all, 1}, {}).empty());
    const OtherModel denies_both = other(judged(scene, {kFar, kNear}));
    EXPECT_TRUE(parts_in_common(best, {&denies_both, 1}, {}).empty());
}

}  // namespace
}  // namespace psfm
