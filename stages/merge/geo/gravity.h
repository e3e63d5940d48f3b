// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <span>

#include "stages/merge/values/merge_options.h"

namespace psfm {

/// A camera's axes in some frame, and the EXIF orientation of its photograph.
struct OrientedCamera {
    Eigen::Quaterniond cam_from_frame;
    std::uint8_t orientation = 1;
};

/// Where up was in a photograph, as its EXIF orientation tells: one of the stored image's four
/// sides. In the camera's frame (x right, y down, z forward); unit length.
/// @param orientation 1..8; anything else counts as 1 (the stored image's top)
Eigen::Vector3d up_in_camera(std::uint8_t orientation);

/// The direction against gravity, seen by the cameras of one frame.
struct Gravity {
    Eigen::Vector3d up;  ///< unit length
    /// Inverse covariance [1/rad^2]: d' information d is the square of how many standard deviations
    /// the direction d (near up) is off. Zero along up.
    Eigen::Matrix3d information;
    /// Whether the photographs tell up from down. They do not when most look straight down.
    bool sign_known = true;
};

/// Photographers hold cameras level: a photograph's horizontal axis is level to a few degrees,
/// whichever way it looks, while its optical axis may be raised or lowered by many. So up is the
/// direction that is perpendicular to all horizontal axes, and less so to the optical axes, in the
/// maximum-likelihood sense (smallest eigenvector of the sum of their outer products, as in
/// Szeliski and others for panoramas), with Cauchy weights against tilted cameras. Cameras that all
/// look one way leave open how far; all optical axes together then count as one observation, as a
/// habit to look up is common to all. Ours (figures: docs/georeferencing.md, "Measured").
/// @return empty without cameras
/// Deterministic. Thread-safe.
std::optional<Gravity> estimate_gravity(std::span<const OrientedCamera> cameras,
                                        const GravityOptions& options);

}  // namespace psfm
