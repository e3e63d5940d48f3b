// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <optional>

#include "graph/result.h"
#include "stages/reconstruction/checks/judge_model.h"
#include "stages/reconstruction/model/cluster_problem.h"
#include "stages/reconstruction/model/solve_options.h"

namespace psfm {

/// Adds new images and small models to a large one at a cost that does not depend on how large it
/// is, beyond a look at each image and each block of points (ScenePoints): local adjustments reach
/// no further than the images' surroundings (surroundings.h), and rotations are averaged,
/// contradictions looked for and places asked after there alone. Whatever needs all of the cluster
/// is left to a solve with all of it: a model that has grown by eta_grow, settling, bad
/// configurations. A fold that an edge of a new image reveals is seen here as there, since the edge
/// is; one that only all rotations together reveal is seen when the model has next grown. Ours;
/// figures: docs/notebook/2026-11-25-image-by-image.md.
/// REQUIRES: the problem's plan has SolveScope::kSurroundings
/// @return nothing when the cluster is to be solved with all of it
/// @errors kCancelled, those of make_local_graph()
/// Deterministic. Thread-safe.
Result<std::optional<SolveAttempt>> extend_locally(const ClusterProblem& problem,
                                                   const SolveOptions& options,
                                                   const std::atomic<bool>* cancel);

}  // namespace psfm
