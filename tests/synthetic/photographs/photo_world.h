// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

namespace psfm::synthetic {

/// A painted rectangle, seen from the side that its normal points to. Its points are
/// corner + u * u_axis + v * v_axis, 0 <= u <= width, 0 <= v <= height [m].
struct PaintedRectangle {
    Eigen::Vector3d corner = Eigen::Vector3d::Zero();
    Eigen::Vector3d u_axis = Eigen::Vector3d::UnitX();  ///< unit
    Eigen::Vector3d v_axis = Eigen::Vector3d::UnitY();  ///< unit, at right angles to u_axis
    double width = 1.0, height = 1.0;                   ///< [m]
    /// 8-bit BGR, each level half the size of the one before; level 0 spans the rectangle exactly.
    std::vector<cv::Mat> levels;

    Eigen::Vector3d normal() const { return u_axis.cross(v_axis); }
    double texels_per_metre() const { return levels.front().cols / width; }
};

/// Where a ray meets the world.
struct SurfaceHit {
    std::uint32_t rectangle = 0;
    double range = 0.0;       ///< in lengths of the direction
    double u = 0.0, v = 0.0;  ///< [m]
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
};

/// Something to photograph. z is up, metres; the ground is z = 0. Immutable once made, thread-safe.
struct PhotoWorld {
    std::vector<PaintedRectangle> rectangles;
    Eigen::Vector3d to_sun = Eigen::Vector3d::UnitZ();
};

/// The nearest rectangle that faces the origin; nothing where the sky is.
std::optional<SurfaceHit> cast_ray(const PhotoWorld& world, const Eigen::Vector3d& origin,
                                   const Eigen::Vector3d& direction);

enum class PhotoScene {
    kCourtyard,  ///< walls 18 m by 16 m around a group of boxes, to be walked around
    kWall,       ///< a wall 12 m wide (along x, at y = 0) with boxes before it, seen from y < 0
};

/// Geometry and paint are functions of scene, seed and scale alone. Nothing in the paint repeats.
/// @param texels_per_metre sharpness of what is close to cameras; half as much on far walls. 200
/// suits
///        1024 pixels' width and takes about 12 million texels in the courtyard.
PhotoWorld make_photo_world(PhotoScene scene, double texels_per_metre, std::uint64_t seed);

}  // namespace psfm::synthetic
