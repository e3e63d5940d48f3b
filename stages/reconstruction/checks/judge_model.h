// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "graph/reconstruction.h"
#include "stages/reconstruction/model/cluster_problem.h"
#include "stages/reconstruction/model/plan_solve.h"
#include "stages/reconstruction/model/solve_options.h"

// When a recycled model is doubted, and whether a new one takes its place.

namespace psfm {

/// One finished model of a cluster.
struct SolveAttempt {
    Reconstruction model;
    std::optional<Succession> succession;  ///< of the model, where there is one
    SolveState state;
    SolveStatistics statistics;
    Contradiction contradiction;
    /// Of the model, where they have been looked for already.
    std::optional<std::vector<std::vector<ImageId>>> places;
};

/// Whether a model that was recycled contradicts the averaged rotations, and something is to be
/// done about it (paper sec. "Detection of Bad Configurations"). One that has been looked at before
/// has to have become worse, unless it is due (SolvePolicy::rotations; ours).
bool is_bad_configuration(const Contradiction& contradiction, const SolveState& state,
                          const DueQuestions& due, const SolveOptions& options);

/// Whether a model leaves out much of its cluster (ResetOptions::stuck_below): what was started
/// with few images may stand where the others cannot be reached from.
bool is_stuck(std::size_t placed, const ClusterProblem& problem, const SolveOptions& options);

/// Whether a recycled model is to be compared with a new one, and why: it is a bad configuration,
/// or it is stuck, in a cluster that has grown since it was started (ours).
std::optional<Reset::Reason> reason_to_reset(const SolveAttempt& attempt,
                                             const ClusterProblem& problem,
                                             const SolveOptions& options);

/// Whether the new model waits until the old one settles (ours): to start a cluster of more images
/// than are affordable (SolvePolicy) takes minutes, for which images would wait, and hardly an edge
/// of it contradicts.
bool is_put_off(const SolveAttempt& attempt, const ClusterProblem& problem, Reset::Reason reason,
                const SolveOptions& options);

/// Whether a new model is the better one. In place of a bad one: a smaller part of its edges
/// contradicts, it explains not much less, and brings no doubt (brings_doubt); when the averaged
/// rotations are wrong, what is built on them agrees with them and loses its structure. In place of
/// a stuck one: it is larger, and hardly an edge contradicts (ours).
bool is_better(const SolveAttempt& fresh, const SolveAttempt& old, Reset::Reason reason,
               const SolveOptions& options);

}  // namespace psfm
