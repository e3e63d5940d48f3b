// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "graph/result.h"
#include "stages/algorithms/averaging/average_rotations.h"
#include "stages/algorithms/averaging/rotation_problem.h"

namespace psfm {

/// Weighted L1 sum of the relative errors, the function that averaging minimises [rad].
double l1_cost(const RotationProblem& problem, const Rows3& errors, RotationNorm norm);

/// The L1 part of average_rotations in one component, starting from problem.node_from_reference and
/// never ending worse than it.
/// @return linearisations done
/// @errors kInternal (the normal matrix cannot be factored)
Result<std::uint32_t> minimize_l1(RotationProblem& problem,
                                  const RotationAveragingOptions& options);

}  // namespace psfm
