// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "graph/rigid3.h"
#include "graph/sim3.h"
#include "graph/two_view_geometry.h"
#include "stages/algorithms/alignment/cluster_index.h"

namespace psfm {

/// One point in two models.
struct PointCorrespondence {
    Eigen::Vector3d in_a = Eigen::Vector3d::Zero();  ///< frame of cluster a
    Eigen::Vector3d in_b = Eigen::Vector3d::Zero();  ///< frame of cluster b
};

/// Distance of two points' projections [longer image sides]; infinity unless both are in front.
/// @param p, q  seen from the camera  @param focal  [longer image sides]
inline double projected_distance(const Eigen::Vector3d& p, const Eigen::Vector3d& q, double focal) {
    if (!(p.z() > 0.0 && q.z() > 0.0)) return std::numeric_limits<double>::infinity();
    return focal * (p.head<2>() / p.z() - q.head<2>() / q.z()).norm();
}

/// An image as merging needs it: distortion matters little to distances between projections and is
/// left out.
struct EdgeView {
    Rigid3 cam_from_cluster;
    double focal = 1.0;  ///< [longer image sides]

    /// Of two points of the cluster, see projected_distance.
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

/// Disagreement of an edge's correspondences with a similarity: the larger distance of the two
/// projections, a's point in b's image and b's point in a's [longer image sides]; infinity unless
/// both are in front. The edge outlives it.
class CorrespondenceError {
  public:
    /// @param a_from_b  the inverse of b_from_a
    CorrespondenceError(const EdgeCorrespondences& edge, const Sim3& b_from_a,
                        const Sim3& a_from_b);

    double operator()(const PointCorrespondence& point) const {
        return std::max(in_a_.distance(point.in_a, point.in_b),
                        in_b_.distance(point.in_b, point.in_a));
    }

  private:
    /// A view that both models' points are projected into; matrices, since points are many.
    struct SharedView {
        Eigen::Matrix3d from_own, from_other;
        Eigen::Vector3d own_origin, other_origin;  ///< seen from the camera
        double focal;

        SharedView(const EdgeView& view, const Sim3& own_from_other);
        double distance(const Eigen::Vector3d& own, const Eigen::Vector3d& other) const {
            return projected_distance(from_own * own + own_origin,
                                      from_other * other + other_origin, focal);
        }
    };
    SharedView in_a_, in_b_;
};

}  // namespace psfm
