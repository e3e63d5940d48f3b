// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>

#include "graph/result.h"
#include "stages/reconstruction/solve/solve_with_ties.h"

namespace psfm {

/// Solves a settled model on where lenses of it have a second radial coefficient (judge_lenses);
/// else it stays as it is. Asked once it is known which cameras are one: photographs of several
/// zooms that are taken for one camera's are described better by any coefficient more.
/// @param attempt  of `problem`
/// @param solve  of problems whose cameras are tied
/// @errors those of `solve`
/// Deterministic where that is.
Result<SolveAttempt> settle_lenses(const ClusterProblem& problem, SolveAttempt attempt,
                                   const SolveOptions& options, const AttemptSolve& solve,
                                   const std::atomic<bool>* cancel);

}  // namespace psfm
