// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <set>

#include "graph/camera.h"
#include "graph/ids.h"
#include "graph/two_view_geometry.h"
#include "stages/reconstruction/model/cluster_problem.h"
#include "stages/verification/verify_options.h"

namespace psfm {

/// Cameras with a lens, as believed now, that moves a corner of the photograph by more than a part
/// of its longer side from where verification saw it, which did not know that lens.
/// @param believed  of these, those with a known focal length are asked
/// @param min_displacement  that part; 0: no lens counts as strong
/// Thread-safe.
std::set<CameraId> strong_lenses(const ClusterProblem& problem,
                                 const std::map<CameraId, Camera>& believed,
                                 double min_displacement);

/// A verified pair as it is seen through such lenses: its geometry is estimated anew from its
/// inliers, since one that was found without the lens is bent by it. (Matches near the rim, which
/// verification may have lost, do not come back.)
/// @param believed  both with a known focal length
/// @return null where less than four fifths of its inliers agree on one: the lens is not believed
/// Deterministic. Thread-safe.
VerifiedPairPtr seen_through(const VerifiedPairPtr& pair, const ClusterImage& image1,
                             const ClusterImage& image2, const std::map<CameraId, Camera>& believed,
                             const VerifyOptions& options);

}  // namespace psfm
