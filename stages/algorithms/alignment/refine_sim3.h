// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "graph/sim3.h"
#include "stages/algorithms/alignment/alignment_options.h"
#include "stages/algorithms/alignment/point_correspondences.h"

namespace psfm {

/// Least squares over the distances of projections in both images of every correspondence that
/// agrees with the start, so that the uncertain depths of points count for little; Huber loss at
/// loss_part of max_error. Levenberg-Marquardt of our own: seven unknowns and up to tens of
/// thousands of residuals, anew in nearly every merge; Ceres's took a third of it.
/// @return the refined similarity; the start itself if it cannot be improved
Sim3 refine_sim3(std::span<const EdgeCorrespondences> edges, const Sim3& b_from_a,
                 const ClusterConstraintOptions& options);

}  // namespace psfm
