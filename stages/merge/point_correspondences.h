// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "graph/rigid3.h"
#include "graph/sim3.h"
#include "graph/two_view_geometry.h"
#include "stages/merge/cluster_index.h"

namespace psfm {

/// One point in two models.
struct PointCorrespondence {
    Eigen::Vector3d in_a = Eigen::Vector3d::Zero();  ///< frame of cluster a
    Eigen::Vector3d in_b = Eigen::Vector3d::Zero();  ///< frame of cluster b
};

/// An image as merging needs it: distortion matters little to distances between projections and is
/// left out.
struct EdgeView {
    Rigid3 cam_from_cluster;
    double focal = 1.0;  ///< [longer image sides]

    /// Distance of two points' projections [longer image sides]; infinity unless both are in front.
    double distance(const Eigen::Vector3d& own, const Eigen::Vector3d& other) const;
};

/// The points that an edge of the view graph ties together.
struct EdgeCorrespondences {
    ImagePair pair;
    EdgeView view_a;
    EdgeView view_b;
    std::vector<PointCorrespondence> points;
    std::uint64_t hash = 0;           ///< of the matches; does not depend on which image came first
    std::uint64_t geometry_hash = 0;  ///< of the matches, the views and the points, to the bit
};

/// Correspondences of a verified pair whose images are in models a and b, either way round; no
/// points when they are not. Matches whose feature belongs to no point, or to one behind its own
/// camera, are left out.
EdgeCorrespondences collect_correspondences(const VerifiedPair& edge, const ClusterIndex& a,
                                            const ClusterIndex& b);

/// Disagreement of a correspondence with a similarity: the larger distance of the two projections,
/// a's point in b's image and b's point in a's [longer image sides].
double correspondence_error(const EdgeCorrespondences& edge, const PointCorrespondence& point,
                            const Sim3& b_from_a, const Sim3& a_from_b);

}  // namespace psfm
