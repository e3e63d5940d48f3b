// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "graph/reconstruction.h"
#include "stages/algorithms/alignment/alignment_options.h"
#include "stages/algorithms/alignment/cluster_constraint.h"

namespace psfm {

/// Whether two models that were taken for those of different places are of one (ours). A joint of
/// them showed images side by side that share nothing, but then it may have been the joint that was
/// wrong: by photographs that a look-alike had misplaced, say, which stand right meanwhile. Each
/// model by itself is right, so they are put together by what their pairs say now, and it is asked
/// as of any two clusters whether their cameras contradict each other where they stand
/// (companions.h). At least ClusterConstraintOptions::min_unmatched_cameras must be matched:
/// cameras that do not meet say nothing.
/// @param pairs  all verified ones between the models, whether they are edges at present or not
/// @return false, too, where that is 0: nothing would tell
/// Deterministic. Thread-safe; parts run in parallel (TBB).
bool stand_together(const Reconstruction& a, const Reconstruction& b, const ClusterPairEdges& pairs,
                    const ClusterConstraintOptions& options);

}  // namespace psfm
