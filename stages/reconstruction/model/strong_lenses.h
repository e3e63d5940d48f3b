// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <set>

#include "graph/camera.h"
#include "graph/ids.h"
#include "graph/two_view_geometry.h"
#include "stages/reconstruction/model/cluster_problem.h"
#include "stages/reconstruction/model/solve_options.h"
#include "stages/verification/verify_options.h"

namespace psfm {

/// The lenses of a cluster that are strong: that move a corner of the photograph by more than a
/// part of its longer side from where verification saw it, which did not know them. Immutable;
/// thread-safe; the problem must outlive it.
class StrongLenses {
  public:
    /// @param believed  cameras as they are believed now: of these, those with a known focal length
    ///        are asked
    StrongLenses(const ClusterProblem& problem, const std::map<CameraId, Camera>& believed,
                 const StrongLensOptions& options);

    /// Whether verification may have bent a pair: it is seen through a strong lens, the focal
    /// lengths of both its images are known, it steps, and the recycled model does not confirm its
    /// rotation.
    /// @param pair  without the lenses, and with the focal lengths that are believed now
    bool may_bend(const VerifiedPair& pair, const ClusterImage& image1,
                  const ClusterImage& image2) const;

  private:
    bool is_confirmed(const VerifiedPair& pair) const;

    const ClusterProblem& problem_;
    StrongLensOptions options_;
    std::set<CameraId> known_;
    std::set<CameraId> strong_;
};

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
