// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "graph/rigid3.h"
#include "stages/algorithms/two_view/sampson.h"

namespace psfm {

/// The four poses of an essential matrix (Hartley & Zisserman, 2nd ed., sec. 9.6.2).
/// @return cam2_from_cam1 with |translation| = 1
std::vector<Rigid3> poses_from_essential(const Eigen::Matrix3d& essential);

/// The poses that a plane's homography x2 ~ h x1 (normalised coordinates) allows: up to four
/// (Malis & Vargas, INRIA RR-6303, as implemented by OpenCV).
/// @return cam2_from_cam1 with |translation| = 1; empty when h is a rotation or the library fails
std::vector<Rigid3> poses_from_homography(const Eigen::Matrix3d& h);

/// Where the rays of correspondences meet that a relative pose brings together. Points are
/// normalised coordinates. Immutable.
class RayMeeting {
  public:
    explicit RayMeeting(const Rigid3& cam2_from_cam1)
        : rotation_(cam2_from_cam1.rotation.toRotationMatrix()),
          translation_(cam2_from_cam1.translation) {}

    /// Whether the nearest points of the rays lie in front of both cameras.
    bool is_in_front(const PointPair& points) const;
    /// Triangulation angle [rad].
    double angle(const PointPair& points) const;
    /// False when the rays meet behind a camera and do so by more than noise: rays that are
    /// parallel within `slack` [rad] pass, since the sign of their depth is chance.
    bool passes_cheirality(const PointPair& points, double slack) const {
        return is_in_front(points) || angle(points) < slack;
    }

  private:
    Eigen::Matrix3d rotation_;
    Eigen::Vector3d translation_;
};

/// The candidate with most correspondences in front of both cameras (ties: the first).
/// REQUIRES: candidates not empty
struct PoseChoice {
    Rigid3 cam2_from_cam1;
    std::size_t in_front = 0;
};
PoseChoice choose_by_cheirality(std::span<const Rigid3> candidates,
                                std::span<const PointPair> points);

/// Median triangulation angle [deg]; 0 without points.
double median_triangulation_angle_deg(const Rigid3& cam2_from_cam1,
                                      std::span<const PointPair> points);

}  // namespace psfm
