// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "graph/result.h"
#include "stages/reconstruction/checks/judge_model.h"
#include "stages/reconstruction/model/plan_solve.h"
#include "stages/reconstruction/model/solve_context.h"

namespace psfm {

/// A model of a cluster without one (paper sec. "Cluster Reconstruction", New): from all images at
/// once where it has more than mu_max, the rest added; else, or where that fails, from the best
/// pair, and from another one when most images stayed out.
/// @param matches  of the graph's pairs
/// @return the largest; empty where no pair starts one
/// @errors kCancelled
/// Deterministic. Thread-safe.
Result<SolveAttempt> solve_new(SolveStart start, const SolveContext& context,
                               const CorrespondenceGraph& matches);

}  // namespace psfm
