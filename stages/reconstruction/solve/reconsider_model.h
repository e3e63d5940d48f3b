// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "graph/result.h"
#include "stages/reconstruction/solve/solve_with_ties.h"

namespace psfm {

/// A cluster whose model was chosen so, without the edges that it denies: what is solved on from it
/// is not led back by these. Nothing: all of them count.
std::optional<ClusterProblem> as_reconsidered(const ClusterProblem& problem,
                                              const DoubtOptions& options);

/// Looks for a better model of a cluster whose model is doubted: where pairs of its images
/// contradict it (missing_regions.h), it denies one of their strongest edges, or it shows several
/// places. A new start is tried, and cuts: the model is taken apart where most of what contradicts
/// it lies between the parts, the edges that held them together are left out, and it is joined
/// again by the edges that it left unexplained; the best is cut again. A local search over what can
/// be believed, as that of Jiang, Tan & Cheong (CVPR 2012) over spanning trees. What the early
/// images decided is so decided again by all of them, and an ambiguous scene ends the same in every
/// order.
/// @param attempt  of `problem`, by `solve`
/// @param solve  of problems like this one, with other models to start from and fewer edges
/// @return the best one; its state notes for how many images it was looked for
/// @errors kCancelled
/// Deterministic where `solve` is.
Result<SolveAttempt> reconsider_model(const ClusterProblem& problem, SolveAttempt attempt,
                                      const SolveOptions& options, const AttemptSolve& solve);

}  // namespace psfm
