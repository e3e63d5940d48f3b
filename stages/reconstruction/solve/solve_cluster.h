// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>

#include "graph/result.h"
#include "stages/reconstruction/model/cluster_problem.h"
#include "stages/reconstruction/model/solve_options.h"

namespace psfm {

/// Reconstructs one cluster (paper sec. "Cluster Reconstruction"): a new model, incrementally, or
/// the recycled one extended. A cluster below mu_min, or one that no pair can start, has an empty
/// model and the reason for each image.
/// @param cancel  when it becomes true the solve ends soon with kCancelled; may be null
/// @errors kInvalidArgument (problem or options violate their invariants), kCancelled, kInternal (a
/// library's exception) Deterministic: bitwise equal for equal problems and options. Thread-safe.
Result<ClusterSolution> solve_cluster(const ClusterProblem& problem, const SolveOptions& options,
                                      const std::atomic<bool>* cancel = nullptr);

}  // namespace psfm
