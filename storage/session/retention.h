// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <set>
#include <vector>

#include "storage/database/store_options.h"
#include "storage/records/cluster_records.h"
#include "storage/records/record_key.h"
#include "storage/records/scene_records.h"

namespace psfm {

/// Beside each placement of `next`: its points are kept for good, because `next` is committed under
/// History::kFull, or because the version before kept them.
std::vector<bool> points_kept_by(const StoredSceneVersion& next, const SceneRecord* latest,
                                 History history);

/// Whether the latest version keeps the points of this solution for good.
bool keeps_points(const SceneRecord* latest, const SolutionKey& key);

/// Solutions parts of which are yet to be joined to other clusters' models.
std::set<SolutionKey> recycled_solutions(const std::map<ClusterId, ClusterRecord>& clusters);

/// Superseded solutions that nobody needs once `next` is the latest scene version: it does not
/// refer to them, they are not recycled, nor the last solution of a removed cluster whose images
/// are in a cluster that is yet to be solved, and none that stays is read from them (FORMAT.md
/// section 6).
std::vector<SolutionKey> droppable_solutions(const SupersededSolutions& superseded,
                                             const StoredSceneVersion& next,
                                             const std::map<ClusterId, ClusterRecord>& clusters);

/// Superseded solutions that those which `scene` refers to are, or are read from.
std::vector<SolutionKey> referred_solutions(const SupersededSolutions& superseded,
                                            const StoredSceneVersion& scene,
                                            const std::map<ClusterId, ClusterRecord>& clusters);

bool refers_to(const StoredSceneVersion& scene, const SolutionKey& key);

}  // namespace psfm
