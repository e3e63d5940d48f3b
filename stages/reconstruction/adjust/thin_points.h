// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "stages/reconstruction/adjust/bundle_adjustment.h"
#include "stages/reconstruction/model/working_model.h"

namespace psfm {

/// Few points that hold some images together, or all when there are none (cover_tracks).
/// @param images  ascending
/// @param points_per_image  an image that observes so many is served
/// @return ascending
std::vector<std::uint32_t> covering_points(const WorkingModel& model,
                                           std::span<const std::uint32_t> images,
                                           std::uint32_t points_per_image);

/// Moves points to where their observations see them, all cameras fixed: Gauss-Newton steps on the
/// residuals and the loss of adjust(), each point by itself, with TBB. Bitwise repeatable.
/// @param points  that move, each once
void refine_points(WorkingModel& model, std::span<const std::uint32_t> points,
                   const AdjustmentOptions& options);

}  // namespace psfm
