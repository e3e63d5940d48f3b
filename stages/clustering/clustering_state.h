// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "graph/clustering_edit.h"
#include "graph/ids.h"
#include "graph/result.h"
#include "graph/view_graph.h"
#include "stages/clustering/clustering_options.h"

namespace psfm {

/// What update_clustering keeps between images: a value, owned by one serial node.
/// Invariants, with the graph and options of the last update:
///   1. links[i] holds, ascending, exactly the neighbours j of i with an edge of some weight and
///   d_ij < eta, and those of rescued[i] with an edge.
///   2. Every image is in exactly one cluster. Two images are in one iff a path of links joins them
///   that are not held; held are those between clusters that may not join (may_join).
///   3. members and cluster_of agree; members ascending, none empty; all ids are below next_id.
///   4. degrees[i] == weighted_degree(graph, i).
struct ClusteringState {
    std::vector<double> degrees;              ///< by image
    std::vector<std::vector<ImageId>> links;  ///< by image
    /// By image, ascending: neighbours that join_late has joined it to last, whatever the distance.
    std::vector<std::vector<ImageId>> rescued;
    std::vector<ClusterId> cluster_of;  ///< by image
    std::map<ClusterId, std::vector<ImageId>> members;
    ClusterId next_id{0};

    std::size_t size() const { return cluster_of.size(); }

    /// Buffers, one entry an image, that make an update cost nothing for images it does not meet.
    /// Between updates weight is all zero. Not part of the value.
    struct Workspace {
        std::vector<double> weight;
        std::vector<std::uint32_t> stamp;
        std::uint32_t last_stamp = 0;
        bool operator==(const Workspace&) const { return true; }
    };
    Workspace workspace;

    bool operator==(const ClusteringState&) const = default;
};

/// All clusters, ascending by id.
std::vector<ClusterMembers> clusters_of(const ClusteringState& state);

/// The state that streaming left, from what the store keeps of it. Parts of a cluster that no
/// distance joins were joined late: the strongest edges between them count as rescued. Cost: one
/// distance an edge.
/// @param next_id the smallest id that no cluster ever had
/// @errors kInvalidArgument (clusters that are not those of this graph and these options, e.g.
/// because the session was made with another eta)
Result<ClusteringState> restore_clustering(const ViewGraph& graph,
                                           std::span<const ClusterMembers> clusters,
                                           ClusterId next_id, const ClusteringOptions& options);

}  // namespace psfm
