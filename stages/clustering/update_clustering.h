// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "graph/clustering_edit.h"
#include "graph/ids.h"
#include "graph/view_graph.h"
#include "stages/clustering/clustering_options.h"
#include "stages/clustering/clustering_state.h"

namespace psfm {

/// Brings the clusters up to date after the view graph changed (paper sec. "Incremental
/// Clustering"): single linkage over the edges with d_ij < eta. Where none is too large to join
/// (may_join), the clusters equal batch_clusters(graph) after every call, in every order of
/// arrival; of several links it is the edges of most weight that join first. A cluster's id follows
/// the rules of ClusteringEdit; "largest" of several joining clusters means the one with most
/// members in the joint cluster.
///
/// Only edges with an endpoint in `touched` get a new distance; joins relabel the smaller side; a
/// lost link starts a search from its endpoints that ends as soon as they meet or all but one side
/// is exhausted. Clusters that are not met cost nothing; those that change cost a copy of their
/// member list, as the edit holds it; of those that fall apart, the links are looked through for
/// some that were held. Differs from the paper, which clusters every cluster anew that has an edge
/// to the new image.
///
/// @param state state of the former graph; empty at the start. Images that it does not know are
/// new.
/// @param touched endpoints of all edges that were added, dropped or reweighted since, in any
/// order, repetitions allowed; new images need not be named REQUIRES: valid options, the same at
/// every call; graph.size() >= state.size(); touched in the graph. Deterministic. Thread-safe for
/// different states.
ClusteringEdit update_clustering(ClusteringState& state, const ViewGraph& graph,
                                 std::span<const ImageId> touched,
                                 const ClusteringOptions& options);

/// What models have shown of images.
struct ShownApart {
    std::span<const std::vector<ImageId>> apart;  ///< by image: EdgeSelection::apart
    std::uint32_t mu_min = 0;                     ///< images that are enough for a model
};

/// What is decided once no more images come: clusters that were held apart for their size are
/// joined, and those of fewer than options.join_below images join what they share most with
/// (rescue_links), which forgets what they were joined to before. The clusters are those of
/// batch_clusters(graph) then, whatever the order of arrival was. A group that makes a model and
/// was shown to be apart from another one stays by itself: what it shares next most with would be
/// no better.
/// Cost: O(links), and a distance for each rescued one. REQUIRES: a state that is up to date with
/// the graph. Deterministic.
ClusteringEdit join_late(ClusteringState& state, const ViewGraph& graph,
                         const ClusteringOptions& options, const ShownApart& shown = {});

}  // namespace psfm
