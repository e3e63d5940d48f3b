// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "graph/result.h"
#include "stages/reconstruction/checks/judge_model.h"
#include "stages/reconstruction/model/solve_context.h"

namespace psfm {

/// A model of a cluster from those that are there (paper sec. "Cluster Reconstruction", Extend and
/// Transfer): joins them, adds the other images, places anew the few that contradict, closes what
/// is open, and adjusts all of it where the cluster settles.
/// @param matches  of the graph's pairs
/// @return with `places` where the models show different ones: they are then not adjusted together
/// @errors kDegenerate, kCancelled
/// Deterministic. Thread-safe.
Result<SolveAttempt> solve_recycled(const SolveContext& context,
                                    const CorrespondenceGraph& matches);

}  // namespace psfm
