// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>

#include "graph/result.h"
#include "stages/reconstruction/model/solve_context.h"

namespace psfm {

/// What came of closing loops.
struct LoopClosing {
    std::uint32_t adjustments = 0;  ///< bundle adjustments done; 0: nothing was open, or closed
    bool shows_one_place = false;   ///< of the closed model, as separate_places() was asked
};

/// Closes loops that drift, or a joint that fits at one of several places, has left open: where
/// images match that the model shows apart, a pose graph of similarities between images spreads
/// what lies between them over the model (Strasdat et al., RSS 2010, for a sequence of
/// photographs), points follow their images, and what has moved against its surroundings is
/// adjusted. Adjustment alone brings nothing together that is further apart than a few pixels.
/// The model stays as it was when that would tear it, cost observations, or show images of
/// different places side by side (separate_places): then it is the edges that are wrong; nor does
/// it change when what has moved cannot be adjusted.
/// @errors kCancelled
Result<LoopClosing> close_loops(WorkingModel& model, const SolveContext& context);

}  // namespace psfm
