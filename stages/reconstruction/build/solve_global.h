// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "graph/result.h"
#include "stages/reconstruction/model/solve_context.h"
#include "stages/reconstruction/model/working_model.h"

namespace psfm {

/// How a model was started globally.
struct GlobalStart {
    std::uint32_t placed = 0;            ///< images registered in the end
    std::uint32_t directions = 0;        ///< between images, that positions could be had from
    std::uint32_t wrong_directions = 0;  ///< of these, by 1DSfM or by the averaged positions
    double noise_deg = 0.0;  ///< of a direction, by the residuals of the averaged positions
    std::uint32_t full_adjustments = 0;
};

/// Starts a model with all images at once (paper sec. "Cluster Reconstruction", New, above mu_max):
/// intrinsics of shared cameras from small models (ours), refined rotations, directions without the
/// outliers that 1DSfM finds, averaged positions, triangulation of consistent tracks, bundle
/// adjustment in rounds with ever smaller errors allowed. Registers the images that can be placed
/// so and keep absolute_pose.min_inliers observations; grow_model may add the others, and the model
/// still wants settling.
///
/// Cameras on a line are placed by means of tracks (GlobalOptions::tracks_per_image); directions
/// between them do not determine their distances.
///
/// @param model  REQUIRES: nothing registered; intrinsics as in graph.cameras
/// @errors kDegenerate (fewer than five images could be placed: the model is as it was, but for
/// intrinsics; the incremental way may still do), kCancelled, kInternal
/// Deterministic for equal problems and options.
Result<GlobalStart> initialize_globally(WorkingModel& model, const SolveContext& context);

}  // namespace psfm
