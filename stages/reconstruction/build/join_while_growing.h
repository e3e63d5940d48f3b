// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

#include "graph/result.h"
#include "stages/reconstruction/build/recycle_models.h"
#include "stages/reconstruction/model/solve_context.h"

namespace psfm {

/// Adjusts what was joined. @return whether to go on with the model
using HandleJoint = std::function<Result<bool>(const Recycling&)>;

/// Adds images to a model to which recycled ones were joined (grow_model). Those of which no edge
/// said where they belong are tried again after some images, then after twice as many, and so on:
/// what was placed of them one by one shares points with the rest, which need not be built a second
/// time (ours).
/// @param recycling  of load_recycled
/// @param handle  called for each joint, that of `recycling` first
/// @errors those of grow_model and `handle`. Deterministic.
Result<void> join_while_growing(SolveDraft& draft, Recycling recycling, const SolveContext& context,
                                const HandleJoint& handle);

}  // namespace psfm
