// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <memory>

#include "graph/reconstruction.h"
#include "graph/result.h"
#include "stages/reconstruction/checks/camera_ties.h"
#include "stages/reconstruction/model/cluster_problem.h"
#include "stages/reconstruction/model/solve_options.h"

namespace psfm {

/// Whether a camera may be asked for a second radial coefficient: it has one, and is not given.
bool has_one_coefficient(const Camera& camera);

/// A model whose cameras of one radial coefficient have a second one (SIMPLE_RADIAL becomes RADIAL)
/// where many images share them, it takes away a clear part of the error, and it leaves the focal
/// length as it was. Two adjustments of some of the points are compared, without and with the
/// coefficients. A lens that one coefficient does not describe bends what it sees by a few
/// thousandths; but where the scene hardly determines the focal length (a flight over flat land), a
/// second coefficient hides its error, and both end far off.
/// Lenses of given cameras, and of turned photographs, which only share them, stay as they are.
/// @param ties  of the model's cameras
/// @return the adjusted model; null where no camera is given one, or nothing could be adjusted
/// @errors kCancelled
Result<std::shared_ptr<const Reconstruction>> judge_lenses(
    const std::shared_ptr<const Reconstruction>& model, const ClusterProblem& problem,
    const CameraTies& ties, const SolveOptions& options, const std::atomic<bool>* cancel);

}  // namespace psfm
