// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "graph/result.h"
#include "stages/reconstruction/model/working_model.h"

namespace psfm {

/// Whether two of a track's images see a position at this triangulation angle [rad] or a larger
/// one.
bool is_seen_from_apart(const WorkingModel& model, std::span<const WorkingModel::Feature> track,
                        const Eigen::Vector3d& position, double min_angle);

struct TrackOptions {
    /// Reprojection error of an observation at most [px]. Higher: more and longer tracks with more
    /// outliers. COLMAP 3.8's filter_max_reproj_error.
    double max_error_px = 4.0;
    /// Largest triangulation angle of a point at least [deg]. Lower: more far points, badly
    /// determined in depth. COLMAP 3.8's filter_min_tri_angle.
    double min_angle_deg = 1.5;
    /// Steps along matches when a track is completed. Higher: longer tracks, slower. COLMAP 3.8: 5.
    int completion_depth = 5;
};

Result<void> validate(const TrackOptions& options);

struct EstimatedPoint {
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    std::vector<WorkingModel::Feature> inliers;  ///< ascending; one an image
};

/// The point that most of the candidate observations agree on, when they do not all: every pair (of
/// the first 20 candidates) is triangulated, the one with most inliers is refined on them. This is
/// where conflicting tracks split: what does not agree stays for another point.
/// @param candidates  features of registered images, several of one image allowed
std::optional<EstimatedPoint> estimate_point(const WorkingModel& model,
                                             std::span<const WorkingModel::Feature> candidates,
                                             const TrackOptions& options);

}  // namespace psfm
