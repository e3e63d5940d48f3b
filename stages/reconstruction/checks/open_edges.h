// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "stages/algorithms/alignment/cluster_pose_graph.h"
#include "stages/reconstruction/model/local_graph.h"
#include "stages/reconstruction/model/loop_options.h"
#include "stages/reconstruction/model/working_model.h"

namespace psfm {

// The edges of a model as a pose graph between its images (local numbers), each image a frame of
// its own that now coincides with the model's. Of the local graph's edges between registered
// images; those that say neither are in neither list. Deterministic. Cost: once through the
// matches, in parallel (TBB).

/// Edges whose matches belong to two points each, apart from one another: one where the first
/// image's surroundings stand, one where the second's do. They ask for bringing these together.
std::vector<PoseGraphEdge> find_open_edges(const WorkingModel& model, const LocalGraph& graph,
                                           const LoopOptions& options);

/// Edges whose images have points in common: they ask for staying as one is. Each image's strongest
/// are enough.
std::vector<PoseGraphEdge> find_holding_edges(const WorkingModel& model, const LocalGraph& graph,
                                              const LoopOptions& options);

}  // namespace psfm
