// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <functional>

#include "graph/result.h"
#include "stages/reconstruction/build/recycle_models.h"
#include "stages/reconstruction/model/cluster_problem.h"
#include "stages/reconstruction/model/local_graph.h"
#include "stages/reconstruction/model/solve_options.h"
#include "stages/reconstruction/model/working_model.h"

namespace psfm {

/// Adjusts what was joined. @return whether the model is gone on with
using HandleJoint = std::function<Result<bool>(const Recycling&)>;

/// Adds images to a model to which recycled ones were joined (grow_model). Those of which no edge
/// said where they belong are tried again after some images, then after twice as many, and so on:
/// what was placed of them one by one shares points with the rest, which need not be built a second
/// time (ours).
/// @param recycling  of load_recycled
/// @param handle  called for each joint, that of `recycling` first
/// @return counts, in `statistics`
/// @errors those of grow_model and `handle`. Deterministic.
Result<void> join_while_growing(WorkingModel& model, Recycling recycling,
                                const ClusterProblem& problem, const LocalGraph& graph,
                                const SolveOptions& options, const std::atomic<bool>* cancel,
                                const HandleJoint& handle, SolveState& state,
                                SolveStatistics& statistics);

}  // namespace psfm
