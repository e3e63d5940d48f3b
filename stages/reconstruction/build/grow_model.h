// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>

#include "graph/result.h"
#include "stages/reconstruction/model/solve_context.h"

namespace psfm {

/// Adds images to a model, one after the other, until no more can be placed (paper, "Extend"): the
/// one that sees most points, spread best, is registered by P3P, its tracks are continued, created
/// and split, its surroundings adjusted; all of the model is adjusted whenever it has grown by
/// eta_grow. What then is left is asked for fewer points (FewPointsOptions).
/// @param draft  its state's images at the last full adjustment are read and written; its
/// statistics count
/// @param at_most  so many images are added
/// @errors kDegenerate (an adjustment of all of the model failed), kCancelled
Result<void> grow_model(SolveDraft& draft, const SolveContext& context,
                        std::uint32_t at_most = std::numeric_limits<std::uint32_t>::max());

}  // namespace psfm
