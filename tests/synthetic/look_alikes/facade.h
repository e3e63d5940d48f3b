// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "tests/synthetic/look_alikes/look_alike_builder.h"
#include "tests/synthetic/rng.h"

namespace psfm::synthetic {

/// How large a facade is, and from where its points are detected.
struct FacadeOptions {
    double width = 40.0, height = 9.0;  ///< [m]
    double relief = 0.4;                ///< standard deviation of its depth [m]
    double points_per_metre = 100.0;    ///< of width
    /// Points are detected from directions within a range of this mean, exponential, at most
    /// max_range_deg; and from distances within scale_range either way of one between nearest and
    /// farthest.
    double mean_range_deg = 25.0, max_range_deg = 70.0;
    double scale_range = 1.8;
    double nearest = 6.0, farthest = 22.0;  ///< [m]
};

/// Directions are those of the camera from the point, tangents of the angle with the facade's
/// normal, seen from above.
struct FacadePoint {
    Eigen::Vector3d in_facade = Eigen::Vector3d::Zero();  ///< x along, y outward, z up [m]
    double from_tangent = 0.0, to_tangent = 0.0;
    double from_distance = 0.0, to_distance = 0.0;  ///< [m]
};
using FacadeDesign = std::vector<FacadePoint>;

/// Points of a facade, `part` of as many as the options ask for.
FacadeDesign draw_facade(const FacadeOptions& options, double part, Rng& rng);

/// x along the facade from left to right as seen from inside the wall, y its outward normal, z up;
/// the origin at the bottom in the middle.
/// @param normal  unit, horizontal
Rigid3 world_from_facade(const Eigen::Vector3d& foot, const Eigen::Vector3d& normal);

/// A facade in the world, its points known to a builder.
struct Facade {
    Rigid3 world_from_facade;
    double half_width = 0.0, reach = 0.0;  ///< [m]; reach: nothing is detected from further off
    FacadeDesign points;
    std::vector<std::uint32_t> indices;  ///< the builder's, one a point
};

/// A design that may stand in several places, its points having the same looks everywhere.
struct SharedDesign {
    FacadeDesign points;
    std::vector<std::uint32_t> looks;
};
SharedDesign share(FacadeDesign points, LookAlikeBuilder& builder);

/// Builds a facade of points that are its own and, when `shared` is set, of points that repeat.
Facade build_facade(const FacadeOptions& options, const Rigid3& world_from_facade,
                    const FacadeDesign& own, const SharedDesign* shared, LookAlikeBuilder& builder);

/// Makes features of what an image may detect of a facade.
/// @param hidden  whether something stands between the camera and a point of the world; may be
/// empty
void observe_facade(const Facade& facade, ImageId image, const Eigen::Vector3d& centre,
                    const std::function<bool(const Eigen::Vector3d& point)>& hidden,
                    LookAlikeBuilder& builder);

}  // namespace psfm::synthetic
