// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "scheduler/session/edges_between_clusters.h"
#include "stages/algorithms/alignment/cluster_constraint.h"
#include "stages/merge/run_merge.h"

namespace psfm {

/// What one merge leaves for the next, so that it looks only at what has changed since. Nothing of
/// it is stored: the first merge of a process looks at everything. What is known of the cameras of
/// each model is with its cluster (ClusterTable::learn_cameras), whose model they belong to.
struct MergeMemory {
    EdgesBetweenClusters between;                ///< as of the last version
    std::vector<ClusterConstraint> constraints;  ///< MergeProblem::known of the next version
    KnownPoses known_poses;                      ///< MergeProblem::known_poses of it

    /// Once the version is published that this result makes.
    void remember(const MergeResult& merged) {
        constraints = merged.constraints;
        constraints.insert(constraints.end(), merged.set_aside.begin(), merged.set_aside.end());
        known_poses = merged.known_poses;
    }
};

}  // namespace psfm
