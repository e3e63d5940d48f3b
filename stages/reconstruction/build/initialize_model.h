// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "graph/result.h"
#include "stages/reconstruction/model/local_graph.h"
#include "stages/reconstruction/model/working_model.h"

namespace psfm {

/// Starts a model from the best two views of the local graph: many inliers with a large
/// triangulation angle, checked by triangulating and adjusting.
/// @param model    empty; holds two images on success, none on failure
/// @param exclude  local indices of images that a start was made from before: pairs of two of them
/// are left out
/// @return the local indices of the two images
/// @errors kNoSeed
Result<std::pair<std::uint32_t, std::uint32_t>> initialize_model(WorkingModel& model,
                                                                 const LocalGraph& graph,
                                                                 const std::vector<bool>& exclude,
                                                                 const SolveOptions& options);

}  // namespace psfm
