// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>

#include "graph/result.h"
#include "stages/reconstruction/model/cluster_problem.h"
#include "stages/reconstruction/model/solve_options.h"

namespace psfm {

/// Reconstructs one cluster (paper sec. "Cluster Reconstruction"). In this order:
/// 1. The cameras that may be one are tied, or not (solve_with_ties.h).
/// 2. What is to be done is planned (plan_solve.h). New images of a large model are added by their
///    surroundings alone (extend_locally.h); where that will not do:
/// 3. Rotations are averaged, and edges that contradict them dropped (local_graph.h).
/// 4. New (solve_new.h), or Extend and Transfer (solve_recycled.h): the models that are there are
///    joined, images added, bad configurations mended, loops closed, all adjusted where it settles.
/// 5. A bad configuration that is left, or a model that leaves much of the cluster out, is compared
///    with a new start (judge_model.h).
/// 6. The ties of cameras are judged; those that do not hold are cut, and 2 to 5 done again.
/// 7. Once no photograph follows, a doubtful model is compared with others (reconsider_model.h).
/// 8. Where it settles, lenses get a second coefficient that need one (settle_lenses.h): it has to
/// be known which cameras are one.
/// 9. A model of two images, or of invented depth, is given up, which empties the attempt, state
/// and places, too; a weak one says so in SolveState::weaknesses (assess_model.h).
/// 10. It is asked whether the model shows several places (separate_places.h), unless step 2, 4 or
/// 7 has asked; of what 8 has solved anew it is asked again.
/// 11. Where it does not, and no photograph follows, it is asked whether images that it leaves out
/// make a model of their own (left_out.h). An empty model leaves nothing out.
///
/// Steps 2 to 5 make a SolveAttempt (judge_model.h) through a SolveDraft; the others take one, and
/// read it and the problem alone: 9 may as well stand behind 10. What a step does is held by the
/// test of its file.
/// A cluster below mu_min, or one that no pair can start, has an empty model and the reason for
/// each image.
/// @param cancel  when it becomes true the solve ends soon with kCancelled; may be null
/// @errors kInvalidArgument (problem or options violate their invariants), kCancelled, kInternal (a
/// library's exception) Deterministic: bitwise equal for equal problems and options. Thread-safe.
Result<ClusterSolution> solve_cluster(const ClusterProblem& problem, const SolveOptions& options,
                                      const std::atomic<bool>* cancel = nullptr);

}  // namespace psfm
