// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <vector>

#include "graph/camera.h"
#include "graph/result.h"
#include "graph/two_view_geometry.h"
#include "stages/verification/verify_options.h"
#include "tests/synthetic/look_alikes/look_alike_pairs.h"
#include "tests/synthetic/look_alikes/look_alike_scene.h"

/// What verification makes of the matches of a LookAlikeScene.
namespace psfm::synthetic {

/// The pair as verification would have it, without the work: the pose that most matches tell, and
/// the matches that agree with its epipolar geometry up to max_error_px as inliers. kPureRotation
/// where they show no parallax of that size, otherwise kEssential.
VerifiedPair explain_pair(const LookAlikeScene& scene, const LookAlikeIndex& index,
                          const LookAlikePair& pair, double max_error_px);

/// The pair as verification (stages/verification) has it, from the matches alone.
/// @param cameras  what is believed of them
/// @errors as verify_pair
Result<VerifiedPair> verify_look_alike(const LookAlikeScene& scene, const LookAlikePair& pair,
                                       const std::map<CameraId, Camera>& cameras,
                                       const VerifyOptions& options);

/// All pairs of a scene, verified; ascending. Those that fail are left out.
std::vector<VerifiedPairPtr> verified_look_alikes(const LookAlikeScene& scene,
                                                  const LookAlikeMatchOptions& match,
                                                  const std::map<CameraId, Camera>& cameras,
                                                  const VerifyOptions& options);

/// What is believed of the cameras: focal lengths a relative `focal_error` off, upwards or
/// downwards by the scene's seed, no distortion, as if from EXIF.
std::map<CameraId, Camera> exif_cameras(const LookAlikeScene& scene, double focal_error);

}  // namespace psfm::synthetic
