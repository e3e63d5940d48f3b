// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

#include "graph/result.h"
#include "stages/reconstruction/solve_options.h"
#include "stages/reconstruction/working_model.h"

namespace psfm {

/// Adjusts all of a model: completes and joins tracks, adjusts, filters, and again until little
/// changes; takes out images that are left with too few observations.
/// @return bundle adjustments done
/// @errors kDegenerate
Result<std::uint32_t> refine_model(WorkingModel& model, bool fix_intrinsics,
                                   const RefinementOptions& refinement,
                                   const SolveOptions& options);

/// Adjusts images and their surroundings: creates and continues their points, adjusts them with the
/// neighbours that share most points with them, filters, and once more where much was filtered.
/// @param images  ascending
/// @return bundle adjustments done
std::uint32_t refine_locally(WorkingModel& model, std::span<const std::uint32_t> images,
                             bool fix_intrinsics, const SolveOptions& options);

/// Registered images with fewer observations than the options ask for are taken out of the model.
/// @return how many
std::uint32_t remove_weak_images(WorkingModel& model, const SolveOptions& options);

}  // namespace psfm
