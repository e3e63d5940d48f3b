// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "stages/reconstruction/bundle_adjustment.h"
#include "stages/reconstruction/working_model.h"

namespace psfm {

/// Few points that hold all images together (cover_tracks).
/// @param points_per_image  an image that observes so many is served
/// @return ascending
std::vector<std::uint32_t> covering_points(const WorkingModel& model,
                                           std::uint32_t points_per_image);

/// Moves points to where their observations see them, all cameras fixed: Gauss-Newton steps on the
/// residuals and the loss of adjust(), each point by itself.
/// @param except  points that stay, ascending
void refine_points(WorkingModel& model, const std::vector<std::uint32_t>& except,
                   const AdjustmentOptions& options);

}  // namespace psfm
