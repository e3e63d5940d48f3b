// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "stages/algorithms/focal/calibrate_focals.h"
#include "stages/algorithms/focal/focal_pair.h"

namespace psfm {

struct FocalVote {
    double log_focal = 0.0;  ///< of the relative focal length
    /// How far single pairs scatter about it, from the width of the highest peak.
    double spread = 0.0;
};

/// The relative focal length on which most pairs agree, all unknown ends sharing it: kernel voting
/// (Li & Hartley, A non-iterative method for correcting lens distortion from nine point
/// correspondences, 2005, use it likewise) over a logarithmic grid, with a parabola through the
/// highest votes. REQUIRES: pairs not empty; every end's parameter is 0. Deterministic.
/// Thread-safe.
FocalVote vote_focal(std::span<const FocalPair> pairs, const FocalCalibrationOptions& options);

}  // namespace psfm
