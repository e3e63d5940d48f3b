// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <span>
#include <vector>

#include "stages/algorithms/focal/calibrate_focals.h"
#include "stages/algorithms/focal/focal_pair.h"

namespace psfm {

/// Pairs prepared for calibration, and the cameras that they are to calibrate.
struct FocalPairs {
    std::vector<CameraId> unknown;  ///< ascending; parameter i is the focal length of unknown[i]
    std::vector<FocalPair> pairs;   ///< ascending by image pair
    double unit_px = 1.0;           ///< unit of the pairs' points [px]
    bool have_points = false;       ///< every pair has its points
};

/// Picks the pairs that tell most (see FocalCalibrationOptions) and prepares them.
/// REQUIRES: cameras valid. Deterministic; the order of pairs does not matter. Thread-safe.
FocalPairs prepare_focal_pairs(std::span<const VerifiedPairPtr> pairs,
                               const std::map<CameraId, Camera>& cameras,
                               const std::map<ImageId, CameraId>& camera_of,
                               const FocalCalibrationOptions& options,
                               const KeypointsOf& keypoints_of);

}  // namespace psfm
