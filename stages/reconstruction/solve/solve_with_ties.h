// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

#include "graph/result.h"
#include "stages/reconstruction/checks/judge_model.h"

namespace psfm {

/// A solve that knows of no ties.
using AttemptSolve = std::function<Result<SolveAttempt>(const ClusterProblem&)>;

/// Solves a cluster some of whose cameras may be one (ClusterProblem::alike): tied as the recycled
/// models have them, or all of a kind. A new model, one that has grown much, and one that settles
/// is asked whether the ties hold (judge_ties); where they do not, it is solved on from there
/// without them.
/// @errors those of `attempt_solve`
/// Deterministic where that is.
Result<SolveAttempt> solve_with_ties(const ClusterProblem& problem, const SolveOptions& options,
                                     const AttemptSolve& attempt_solve);

}  // namespace psfm
