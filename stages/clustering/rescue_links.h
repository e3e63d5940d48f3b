// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "graph/ids.h"
#include "graph/view_graph.h"

namespace psfm {

/// By image, ascending: neighbours that are joined whatever else is.
using NearNeighbors = std::vector<std::vector<ImageId>>;

/// The images that near ones lead to from an image, up to `at_least` of them: fewer are all.
/// In order of discovery, the image itself first.
std::vector<ImageId> small_group(const NearNeighbors& near, ImageId image, std::uint32_t at_least);

/// All images of groups of fewer than `join_below`, ascending.
std::vector<ImageId> in_small_groups(const NearNeighbors& near, std::uint32_t join_below);

/// Links that join groups of fewer than `join_below` images to what they share most with (ours): a
/// thin scene has no dense parts, and falls into pieces which are too small to be reconstructed,
/// though together they would make a model. Edges are taken by strength, those that count in
/// distances before weak ones, each by its inliers times its plausibility, and join two groups of
/// which at least one is too small yet (Kruskal's algorithm, ended early). What they join depends
/// on the graph alone, not on the order of arrival; look-alikes among them are told apart later, by
/// what the model shows.
/// @param images  of small groups, ascending: all of them that edges connect with one another
/// @return the links that have an end among these, ascending
std::vector<ImagePair> rescue_links(const NearNeighbors& near, const ViewGraph& graph,
                                    std::span<const ImageId> images, std::uint32_t join_below);

/// The strongest edges that join the parts into which near ones leave some images, ascending; as
/// few as it takes, and none that leads out of these images.
std::vector<ImagePair> links_within(const NearNeighbors& near, const ViewGraph& graph,
                                    std::span<const ImageId> images);

}  // namespace psfm
