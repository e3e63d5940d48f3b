// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <unordered_map>
#include <vector>

#include "graph/clustering_edit.h"
#include "graph/ids.h"
#include "stages/clustering/clustering_state.h"

namespace psfm {

/// A new grouping on top of a state: cluster_of holds provisional labels, members the former
/// clusters. Images that kept their cluster's label are not listed.
struct Relabelling {
    std::vector<ImageId> arrived;                   ///< images that were in no cluster
    std::unordered_map<ImageId, ClusterId> former;  ///< former cluster of images that changed label
};

/// Gives the groups their ids by the rules of ClusteringEdit, and brings members, cluster_of and
/// next_id of the state up to date. Fresh ids go to new groups in ascending order of their smallest
/// image. REQUIRES: a label that is no former cluster's id is at least next_id.
ClusteringEdit apply_relabelling(ClusteringState& state, const Relabelling& relabelling);

}  // namespace psfm
