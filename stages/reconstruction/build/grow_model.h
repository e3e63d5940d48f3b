// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <vector>

#include "graph/result.h"
#include "stages/reconstruction/model/cluster_problem.h"
#include "stages/reconstruction/model/solve_options.h"
#include "stages/reconstruction/model/working_model.h"

namespace psfm {

/// Adds images to a model, one after the other, until no more can be placed (paper, "Extend"): the
/// one that sees most points, spread best, is registered by P3P, its tracks are continued, created
/// and split, its surroundings adjusted; all of the model is adjusted whenever it has grown by
/// eta_grow. What then is left is asked for fewer points (FewPointsOptions).
/// @param state  images at the last full adjustment: read and written
/// @param at_most  so many images are added
/// @return counts; SolveStatistics::kind is left alone
/// @errors kDegenerate (an adjustment of all of the model failed), kCancelled
Result<void> grow_model(WorkingModel& model, const ClusterProblem& problem,
                        const SolveOptions& options, const std::atomic<bool>* cancel,
                        SolveState& state, SolveStatistics& statistics,
                        std::uint32_t at_most = std::numeric_limits<std::uint32_t>::max());

}  // namespace psfm
