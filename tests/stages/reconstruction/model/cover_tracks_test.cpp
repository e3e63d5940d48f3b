// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/model/cover_tracks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace psfm {
namespace {

using Feature = CorrespondenceGraph::Feature;

TEST(ConsistentTracks, FollowMatches) {
    const std::vector<FeatureMatch> same{{0, 0}, {1, 1}};
    const std::vector<FeatureMatch> crossed{{0, 1}};
    const std::vector<MatchedImages> pairs{{0, 1, same}, {1, 2, crossed}, {3, 2, crossed}};
    const auto tracks = consistent_tracks(pairs, std::vector<std::uint32_t>(4, 2), 2);
    const std::vector<FeatureTrack> expected{{{0, 0}, {1, 0}, {2, 1}, {3, 0}}, {{0, 1}, {1, 1}}};
    EXPECT_EQ(tracks, expected);
    EXPECT_EQ(consistent_tracks(pairs, std::vector<std::uint32_t>(4, 2), 3).size(), 1U);
}

TEST(ConsistentTracks, LeaveOutAMatchThatContradictsStrongerPairs) {
    const std::vector<FeatureMatch> right{{0, 0}, {1, 1}, {2, 2}};
    const std::vector<FeatureMatch> wrong{{1, 2}};
    const std::vector<FeatureTrack> expected{
        {{0, 0}, {1, 0}, {2, 0}}, {{0, 1}, {1, 1}, {2, 1}}, {{0, 2}, {1, 2}, {2, 2}}};
    const std::vector<MatchedImages> pairs{{0, 2, wrong}, {0, 1, right}, {1, 2, right}};
    EXPECT_EQ(consistent_tracks(pairs, std::vector<std::uint32_t>(3, 3), 2), expected);
}

TEST(ConsistentTracks, IgnoreFeaturesThatAreNotThere) {
    const std::vector<FeatureMatch> matches{{0, 0}, {1, 7}};
    const std::vector<MatchedImages> pairs{{0, 1, matches}};
    EXPECT_EQ(consistent_tracks(pairs, std::vector<std::uint32_t>(2, 2), 2).size(), 1U);
}

TEST(CoverTracks, ServesEachImageWithAFewLongTracks) {
    std::vector<FeatureTrack> tracks;
    for (std::uint32_t feature = 0; feature < 40; ++feature) {
        FeatureTrack track;
        for (std::uint32_t image = feature % 3; image < 10; image += 1 + feature % 4) {
            track.push_back({image, feature});
        }
        tracks.push_back(track);
    }
    const std::vector<std::span<const Feature>> views(tracks.begin(), tracks.end());
    const auto chosen = cover_tracks(views, 10, 4);
    std::vector<std::uint32_t> served(10, 0);
    for (const std::uint32_t track : chosen) {
        for (const Feature& feature : tracks[track]) ++served[feature.image];
    }
    EXPECT_GE(std::ranges::min(served), 4U);
    EXPECT_LE(chosen.size(), 8U);
    EXPECT_EQ(tracks[chosen.front()].size(), 10U);
    EXPECT_TRUE(cover_tracks(views, 10, 0).empty());
}

}  // namespace
}  // namespace psfm
