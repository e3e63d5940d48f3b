// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "scheduler/session/session_config.h"
#include "scheduler/session/session_state.h"
#include "stages/merge/adopt/find_adoptions.h"
#include "stages/merge/run_merge.h"
#include "stages/reconstruction/model/cluster_problem.h"
#include "stages/reconstruction/model/solve_options.h"

namespace psfm {

/// What solving a cluster needs, cut out of the session's state. Features and pairs are shared, not
/// copied.
/// @param settle  adjust to convergence instead of adding images
std::shared_ptr<const ClusterProblem> make_cluster_problem(const SessionState& state,
                                                           const SessionConfig& config,
                                                           const SolveOptions& options,
                                                           const ClusterEntry& entry, bool settle);

/// All clusters with the view graph's edges between placed images of different ones. Models of
/// clusters that rest are without points.
std::shared_ptr<MergeProblem> make_merge_problem(SessionState& state, const SessionConfig& config,
                                                 const MergeOptions& options);

/// Images that a solved cluster could not place and that have edges to what other clusters place:
/// to be tried against the merged model, ascending. Not those that were adopted already: they stay
/// with their host until something changes around them. And not those that were tried for the last
/// version, unless their own cluster or one that they see has been solved since: where clusters
/// move against one another all of them are tried again when they settle at the latest.
std::vector<UnplacedImage> unplaced_images(const SessionState& state, const SessionConfig& config);

}  // namespace psfm
