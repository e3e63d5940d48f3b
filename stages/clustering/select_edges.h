// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "graph/ids.h"
#include "graph/result.h"
#include "graph/two_view_geometry.h"
#include "graph/view_graph.h"
#include "stages/clustering/plausibility.h"
#include "stages/clustering/still_features.h"

namespace psfm {

/// What counts as an edge of the view graph. Figures behind "ours": docs/look-alikes.md.
struct EdgeSelectionOptions {
    /// Verified inliers that an edge needs. Raised: sparse overlaps are lost, and with them images
    /// and the connections between clusters. Lowered: chance agreements become edges. Ours: a free
    /// fundamental matrix finds 40 to 60 inliers between temple images that share nothing, true
    /// neighbours there have 150 at 20 degrees and 63 at 30 (temple-341 of docs/datasets.md).
    std::uint32_t min_inliers = 30;
    /// An edge that is less plausible (see plausibility) than this part of what both of its images
    /// reach elsewhere is none; 0: every pair is an edge, as in the paper. Raised: weak true
    /// overlaps are left out where strong ones exist. Lowered: look-alikes stay in. Ours
    /// (docs/look-alikes.md, "Relative plausibility").
    double min_relative_plausibility = 0.3;
    PlausibilityOptions plausibility;
    /// Verified inliers from which a pair that is no such edge is a weak one (ViewGraph::Edge): it
    /// joins what nothing better joins, and models take its matches where its rotation agrees with
    /// theirs; 0: there are none, as in the paper. Raised: images with little overlap are left out.
    /// Lowered: chance agreements are looked at. Source: COLMAP's min_num_inliers.
    std::uint32_t min_weak_inliers = 15;
    StillFeatureOptions still;
};

Result<void> validate(const EdgeSelectionOptions& options);

/// The pairs of images that are plausible, in the view graph or not: a value, owned by one serial
/// node. Invariants, with the graph and options of the last call:
///   1. best[i] is the largest plausibility of the pairs of image i with enough inliers that show
///      motion; a pair is plausible iff it reaches min_relative_plausibility times the smaller of
///      its images' best.
///   2. A pair is an edge of the graph iff it is plausible, its images are not known to be of
///      different places, neither image is outvoted for the other (outvoted_neighbors), and it does
///      not rest on what stands still in photographs (without_still).
///   3. A pair that is not plausible and has min_weak_inliers is a weak edge of the graph iff its
///      images are not known to be of different places, neither is apart from a plausible neighbour
///      of the other, and it does not rest on what stands still in photographs.
///   4. The edge's pair is without what is known to stand still.
struct EdgeSelection {
    struct Edge {
        ImageId neighbor{};
        double plausibility = 0.0;
        VerifiedPairPtr pair;
    };
    std::vector<std::vector<Edge>> edges;  ///< by image: plausible pairs
    std::vector<std::vector<Edge>> weak;   ///< by image: the others with min_weak_inliers
    std::vector<double> best;              ///< by image; 0 without a pair
    /// By image, ascending: images that a model showed beside it and that are of another place
    /// (keep_apart). Goes both ways.
    std::vector<std::vector<ImageId>> apart;
    std::size_t apart_count = 0;                    ///< pairs in apart
    std::vector<std::vector<ImageId>> outvoted;     ///< by image, ascending: outvoted_neighbors
    std::vector<std::vector<std::uint32_t>> still;  ///< by image: still_features of its pairs above
    std::vector<std::uint32_t> still_only;          ///< by image: pairs that show nothing else
    StillFeatureOptions still_options;              ///< of the last call

    bool are_apart(ImageId a, ImageId b) const;
};

/// What changed in the view graph.
struct EdgeChanges {
    std::vector<ImageId> images;     ///< whose edges changed, a new one among them; ascending
    std::vector<ImagePair> removed;  ///< edges that are none any more, ascending
};

/// Adds an image with its pairs to the view graph, and takes out the edges that are no longer
/// plausible beside better ones. A look-alike is only as convincing as nothing better is known of
/// an image: while it is alone among look-alikes its edges to them stay, and when its true
/// neighbours arrive they go. No pair is judged for good: which pairs are edges depends on the set
/// of images, not on the order of their arrival, and pairs stay in the store whatever becomes of
/// them (paper sec. "Progressive Viewgraph": no rejection in the view graph). The paper has no such
/// step; with min_relative_plausibility 0 there is none here. An image that has pairs with two
/// places which are known to be different gets edges to one of them (outvoted_neighbors).
///
/// @param pairs  of `image` with earlier images
/// REQUIRES: image == graph.size(), the next one; valid options, the same at every call.
/// Cost: O(pairs + edges of the images whose best pair is among them). Deterministic.
EdgeChanges select_edges(EdgeSelection& selection, ViewGraph& graph, ImageId image,
                         std::span<const VerifiedPairPtr> pairs,
                         const EdgeSelectionOptions& options);

}  // namespace psfm
