// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "graph/sim3.h"
#include "stages/merge/geo/georeference.h"
#include "tests/synthetic/rng.h"
#include "tests/synthetic/scene.h"

/// Cameras on the earth as a component of a gauge of its own sees them.
namespace psfm::test {

inline constexpr double kRad = std::numbers::pi / 180.0;

/// A camera at the origin of an east-north-up frame that looks along a compass heading.
/// @param roll_deg, pitch_deg  how badly it is held: pitch > 0 looks up
/// @param orientation  EXIF: how the sensor was turned
inline Eigen::Quaterniond held(double heading_deg, double pitch_deg, double roll_deg,
                               std::uint8_t orientation) {
    const double heading = heading_deg * kRad;
    const double pitch = pitch_deg * kRad;
    const Eigen::Vector3d level(std::sin(heading), std::cos(heading), 0.0);
    const Eigen::Vector3d forward =
        std::cos(pitch) * level + std::sin(pitch) * Eigen::Vector3d::UnitZ();
    Eigen::Vector3d up = std::cos(pitch) * Eigen::Vector3d::UnitZ() - std::sin(pitch) * level;
    up = Eigen::AngleAxisd(roll_deg * kRad, forward) * up;
    const Eigen::Vector3d right = forward.cross(up);
    // Which directions of the world the stored image's x (right) and y (down) axes were.
    Eigen::Vector3d x = right;
    Eigen::Vector3d y = -up;
    if (orientation == 3) {
        x = -right;
        y = up;
    } else if (orientation == 6) {  // to be turned clockwise for display
        x = -up;
        y = -right;
    } else if (orientation == 8) {
        x = up;
        y = right;
    }
    Eigen::Matrix3d cam_from_enu;
    cam_from_enu << x.transpose(), y.transpose(), forward.transpose();
    return Eigen::Quaterniond(cam_from_enu);
}

struct Walk {
    std::vector<LocatedCamera> cameras;
    std::vector<OrientedCamera> oriented;
    Sim3 enu_from_component;  ///< truth

    double largest_error(const Sim3& found) const {
        double largest = 0.0;
        for (const LocatedCamera& camera : cameras) {
            largest = std::max(largest,
                               (found * camera.centre - enu_from_component * camera.centre).norm());
        }
        return largest;
    }
    double turned_deg(const Sim3& found) const {
        return angle_between(found.rotation, enu_from_component.rotation) / kRad;
    }
};

struct WalkOptions {
    double horizontal_noise = 5.0;  ///< [m], standard deviation each way
    double vertical_noise = 15.0;
    bool altitudes = true;
    double outliers = 0.0;  ///< part of the positions that is 50 to 500 m off
    double roll_noise_deg = 2.0;
    double pitch_noise_deg = 5.0;
    std::vector<std::uint8_t> orientations{1};  ///< in turn
};

/// @param places  true camera centres [m], east-north-up
/// @param heading_deg  where camera k looks: heading + k * turn
inline Walk take_walk(const std::vector<Eigen::Vector3d>& places, double heading_deg,
                      double turn_deg, const WalkOptions& options, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform;
    Walk walk;
    walk.enu_from_component = inverse(synthetic::random_gauge(seed));
    walk.enu_from_component.scale = 7.0;
    const Sim3 component_from_enu = inverse(walk.enu_from_component);
    for (std::size_t k = 0; k < places.size(); ++k) {
        Eigen::Vector3d enu = places[k];
        enu.head<2>() += options.horizontal_noise * Eigen::Vector2d(normal(random), normal(random));
        enu.z() += options.vertical_noise * normal(random);
        if (uniform(random) < options.outliers) {
            const double direction = 2.0 * std::numbers::pi * uniform(random);
            enu.head<2>() += (50.0 + 450.0 * uniform(random)) *
                             Eigen::Vector2d(std::cos(direction), std::sin(direction));
        }
        if (!options.altitudes) enu.z() = 0.0;
        walk.cameras.push_back({component_from_enu * places[k], enu, options.altitudes});
        const std::uint8_t orientation = options.orientations[k % options.orientations.size()];
        const Eigen::Quaterniond cam_from_enu =
            held(heading_deg + turn_deg * static_cast<double>(k),
                 options.pitch_noise_deg * normal(random), options.roll_noise_deg * normal(random),
                 orientation);
        walk.oriented.push_back({cam_from_enu * walk.enu_from_component.rotation, orientation});
    }
    return walk;
}

/// Along a straight street that goes north-east, `step` metres at a time.
inline std::vector<Eigen::Vector3d> street(std::size_t count, double step) {
    std::vector<Eigen::Vector3d> places;
    for (std::size_t k = 0; k < count; ++k) {
        const double along = step * static_cast<double>(k);
        places.emplace_back(0.6 * along + 40.0, 0.8 * along - 25.0, 1.6);
    }
    return places;
}

/// Around a block.
inline std::vector<Eigen::Vector3d> around(std::size_t count, double radius) {
    std::vector<Eigen::Vector3d> places;
    for (std::size_t k = 0; k < count; ++k) {
        const double angle =
            2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(count);
        places.emplace_back(radius * std::cos(angle), 0.7 * radius * std::sin(angle), 3.0);
    }
    return places;
}

}  // namespace psfm::test
