// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "graph/two_view_geometry.h"
#include "stages/reconstruction/model/correspondence_graph.h"

namespace psfm {

/// Features of one scene point, one an image, ascending.
using FeatureTrack = std::vector<CorrespondenceGraph::Feature>;

/// The matches of a pair, its images by local index.
struct MatchedImages {
    std::uint32_t image1 = 0;
    std::uint32_t image2 = 0;
    std::span<const FeatureMatch> matches;
};

/// Tracks that matches connect, such that none meets an image twice: matches of pairs with many
/// come first, and one that would join two tracks with a common image is left out (it, or one
/// before it, is wrong).
/// @param feature_counts  by local image
/// @param min_images  shorter tracks are left out
/// @return in the order of their first features. O(matches * track length)
std::vector<FeatureTrack> consistent_tracks(std::span<const MatchedImages> pairs,
                                            std::span<const std::uint32_t> feature_counts,
                                            std::size_t min_images);

/// Few tracks that hold all images together: the longest first, those that give at least two images
/// one of the tracks they are short of (Wilson & Snavely 2014, sec. 4.3, cover images in such a
/// way).
/// @param tracks  at most one feature an image
/// @param tracks_per_image  an image with so many is served
/// @return indices of tracks, longest tracks first
std::vector<std::uint32_t> cover_tracks(
    std::span<const std::span<const CorrespondenceGraph::Feature>> tracks, std::size_t image_count,
    std::uint32_t tracks_per_image);

}  // namespace psfm
