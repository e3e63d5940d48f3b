// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "graph/result.h"
#include "stages/reconstruction/solve/solve_with_ties.h"

namespace psfm {

/// What a cluster's model leaves out though it makes models of its own: images that had one before
/// it was joined to this one and found no place in it, or of which a new start makes one. As far as
/// anybody knows they are of another place (ours: the paper adds images one by one where models do
/// not join, and those that cannot be added wait). Asked once no more images come: until then what
/// joins the models may be under way.
/// @param attempt  of `problem`, to be published
/// @param solve  of problems like this one, with fewer images
/// @return the cluster's images in as many lists as there are models, each ascending, those of the
/// attempt's first; images of none are with those that they match best. Empty: nothing of the kind
/// is left out
/// @errors kCancelled
/// Deterministic where `solve` is.
Result<std::vector<std::vector<ImageId>>> places_of_left_out(const ClusterProblem& problem,
                                                             const SolveAttempt& attempt,
                                                             const SolveOptions& options,
                                                             const AttemptSolve& solve);

}  // namespace psfm
