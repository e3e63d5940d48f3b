// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "stages/clustering/clustering_state.h"
#include "stages/clustering/select_edges.h"

namespace psfm {

/// What a model says of the pairs of its images.
struct PlaceVerdict {
    std::vector<ImagePair> apart;     ///< are of different places; were not known to be
    std::vector<ImagePair> together;  ///< are of one place; were taken for different ones
    bool empty() const { return apart.empty() && together.empty(); }
};

/// Compares what is known with a model that was just solved.
/// @param images  of the model, ascending
/// @param places  images of different places among them, each ascending; the others are of any
PlaceVerdict judge_places(const EdgeSelection& selection, std::span<const ImageId> images,
                          std::span<const std::vector<ImageId>> places);

/// Known pairs between images of a model that `places` leaves alone (of a place that is too small
/// for a model) and images that are not in it. Of two models that leave an image nowhere together
/// one is wrong, and the earlier one showed more than one place.
/// @param images, places  as in judge_places  @return ascending
std::vector<ImagePair> apart_before(const EdgeSelection& selection, std::span<const ImageId> images,
                                    std::span<const std::vector<ImageId>> places,
                                    std::uint32_t mu_min);

/// Takes pairs of images that are of different places out of the view graph, and takes back those
/// that are of one place after all. Every pair stays known; the images' other pairs are counted
/// again (outvoted_neighbors).
EdgeChanges keep_apart(EdgeSelection& selection, ViewGraph& graph, const PlaceVerdict& verdict);

/// The known pairs with their smaller image among `images` (ascending), ascending.
std::vector<ImagePair> apart_pairs_of(const EdgeSelection& selection,
                                      std::span<const ImageId> images);

/// Whether a plausible pair between two clusters has this part of the matches of the best pair that
/// one of its images has anywhere: they are of one place, then, or that image stands in the wrong
/// one.
bool hang_together(const ClusteringState& clustering, const EdgeSelection& selection, ClusterId a,
                   ClusterId b, double min_relative);

/// Images of clusters that such pairs connect, a list for each set of clusters, ascending.
std::vector<std::vector<ImageId>> images_held_apart(const ClusteringState& clustering,
                                                    const EdgeSelection& selection);

}  // namespace psfm
