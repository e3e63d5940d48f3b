// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "stages/reconstruction/model/cluster_problem.h"
#include "stages/reconstruction/model/solve_policy.h"

namespace psfm {

/// What a solve begins with (paper sec. "Cluster Reconstruction").
enum class SolveStart : std::uint8_t {
    kNone,         ///< the cluster has fewer than mu_min images
    kIncremental,  ///< New, from the best pair
    kGlobal,       ///< New, from all images at once; incrementally where that fails
    kRecycled,     ///< Extend, and Transfer: from the models that are there
};

/// The questions about a model that cost more than looking at what was added. Each is asked of any
/// model; here stands which ones are due, as it is now.
struct DueQuestions {
    bool full_adjustment = false;  ///< has it grown so much that more than its newest is adjusted?
    /// Does it contradict the averaged rotations? A contradiction that was kept is asked again.
    bool rotations = false;
    bool places = false;     ///< does it show several (separate_places)?
    bool loops = false;      ///< is anything open in it that could close (close_loops)?
    bool new_start = false;  ///< where it leaves much of its cluster out: does a new one not?
    bool ties = false;       ///< which of its cameras may be one (judge_ties)?
    bool worth = false;      ///< is its depth invented, is it weak (assess_model.h)?
    bool others = false;     ///< is there a better model of its images (reconsider_model)?
    bool operator==(const DueQuestions&) const = default;
};

/// What is done in a solve, by the sizes of things alone.
struct SolvePlan {
    SolveStart start = SolveStart::kNone;
    /// The smallest that may do: what the surroundings cannot answer is solved with all of the
    /// cluster, and planned again from where it stands.
    SolveScope scope = SolveScope::kAll;
    SolveEffort effort = SolveEffort::kConverged;
    DueQuestions due;
    bool operator==(const SolvePlan&) const = default;
};

/// The plan of a solve before anything is done: sizes are those of the largest recycled model, of
/// the cluster where there is none. A model that settles is in the end adjusted as a whole to
/// convergence, whatever its size. Pure. Thread-safe.
SolvePlan plan_solve(const ClusterProblem& problem, const SolvePolicy& policy);

/// The plan of the next step from where a solve stands: what is added or joined before a model
/// settles is adjusted by its size, too.
/// @param placed  images of the model in work
/// @param state  what is known of it
SolvePlan plan_solve(const ClusterProblem& problem, const SolveState& state, std::size_t placed,
                     const SolvePolicy& policy);

/// What a new start of a cluster begins with, whatever models there are.
SolveStart new_start_of(const ClusterProblem& problem, const SolvePolicy& policy);

/// The state of the first recycled model. Of what was adjusted, images may have left it since: they
/// do not stand in for others that come.
/// REQUIRES: problem.recycled not empty
SolveState state_of_recycled(const ClusterProblem& problem);

}  // namespace psfm
