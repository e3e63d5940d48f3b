// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "graph/ids.h"
#include "graph/view_graph.h"
#include "scheduler/session/cluster_table.h"
#include "stages/algorithms/alignment/alignment_options.h"
#include "stages/algorithms/alignment/cluster_constraint.h"
#include "stages/clustering/select_edges.h"

namespace psfm {

/// The view graph's edges between images that different clusters place, from version to version:
/// only clusters that have changed are looked at again. Not thread-safe.
class EdgesBetweenClusters {
  public:
    /// @param options  which weak edges match cameras; the same at every call
    /// @return ascending by clusters; pairs of clusters that have not changed are those of before
    std::vector<ClusterPairEdgesPtr> update(const ClusterTable& clusters,
                                            const ViewGraph& view_graph,
                                            const ClusterConstraintOptions& options);

  private:
    /// What a cluster placed when it was looked at.
    struct Placed {
        std::uint64_t changes = 0;  ///< ClusterEntry::placing_changes
        std::vector<ImageId> images;
    };
    using ClusterPair = std::pair<ClusterId, ClusterId>;

    /// Forgets what these placed, and their edges.
    void forget(const std::vector<ClusterId>& clusters);
    struct Found {
        std::vector<VerifiedPairPtr> edges;
        std::vector<ImagePair> weak;
    };
    /// Each edge of a changed cluster once. @param changed  ascending
    std::map<ClusterPair, Found> collect(const std::vector<ClusterId>& changed,
                                         const ViewGraph& view_graph,
                                         const ClusterConstraintOptions& options) const;

    std::map<ClusterId, Placed> placed_;
    std::vector<std::optional<ClusterId>> placing_;  ///< by image
    std::map<ClusterPair, ClusterPairEdgesPtr> between_;
};

/// The plausible pairs between the images that two clusters place, edges at present or not (of
/// clusters that are kept apart none is), and those of the weak ones that match cameras.
/// @param graph  that of the session, by which they do (WeakMatches)
/// REQUIRES: both have a model
ClusterPairEdgesPtr verified_between(const EdgeSelection& selection, const ViewGraph& graph,
                                     const ClusterEntry& a, const ClusterEntry& b,
                                     const ClusterConstraintOptions& options);

}  // namespace psfm
