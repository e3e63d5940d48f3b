// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "graph/result.h"
#include "stages/algorithms/averaging/average_rotations.h"
#include "stages/algorithms/averaging/rotation_problem.h"

namespace psfm {

/// Weight of a squared residual in reweighted least squares: loss'(r) / r up to a factor.
/// @param residual in units of the loss's scale, >= 0
double loss_weight(RotationLoss loss, double residual);

/// Refinement by iteratively reweighted least squares in one component (Chatterjee & Govindu 2013,
/// sec. 4).
/// @return linearisations done
/// @errors kInternal (the normal matrix cannot be factored)
Result<std::uint32_t> refine_rotations(RotationProblem& problem,
                                       const RotationAveragingOptions& options);

}  // namespace psfm
