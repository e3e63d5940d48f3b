// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "stages/algorithms/averaging/relative_direction.h"
#include "tests/synthetic/compare.h"
#include "tests/synthetic/rng.h"

namespace psfm {

/// Positions, and directions between those at most `reach` apart.
struct PlantedDirections {
    std::vector<Eigen::Vector3d> positions;
    std::vector<RelativeDirection> edges;
    std::vector<bool> wrong;  ///< by edge
};

inline Eigen::Vector3d turned(const Eigen::Vector3d& direction, double sigma_deg,
                              synthetic::Rng& rng) {
    // Across the direction, the chord of a small turn has this deviation in both coordinates.
    const Eigen::Vector3d deviation = sigma_deg * std::numbers::pi / 180.0 * rng.normal3();
    const Eigen::Vector3d across = deviation - deviation.dot(direction) * direction;
    return (direction + across).normalized();
}

inline PlantedDirections plant_directions(std::vector<Eigen::Vector3d> positions, double reach,
                                          double noise_deg, std::uint64_t seed) {
    synthetic::Rng rng(seed);
    PlantedDirections planted;
    for (std::uint32_t i = 0; i < positions.size(); ++i) {
        for (std::uint32_t j = i + 1; j < positions.size(); ++j) {
            const Eigen::Vector3d difference = positions[j] - positions[i];
            if (difference.norm() > reach) continue;
            planted.edges.push_back({i, j, turned(difference.normalized(), noise_deg, rng), 1.0});
        }
    }
    planted.wrong.assign(planted.edges.size(), false);
    planted.positions = std::move(positions);
    return planted;
}

/// Within the unit ball.
inline std::vector<Eigen::Vector3d> cloud(std::size_t count, std::uint64_t seed) {
    synthetic::Rng rng(seed);
    std::vector<Eigen::Vector3d> positions;
    for (std::size_t k = 0; k < count; ++k) {
        positions.push_back(std::cbrt(rng.uniform()) * rng.direction());
    }
    return positions;
}

/// About the z axis, at radius 1, out of the plane by `height` (standard deviation).
inline std::vector<Eigen::Vector3d> ring(std::size_t count, double height, std::uint64_t seed) {
    synthetic::Rng rng(seed);
    std::vector<Eigen::Vector3d> positions;
    for (std::size_t k = 0; k < count; ++k) {
        const double angle =
            2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(count);
        positions.emplace_back(std::cos(angle), std::sin(angle), height * rng.normal());
    }
    return positions;
}

/// Along x from 0 to 1, off the line by `deviation`.
inline std::vector<Eigen::Vector3d> line(std::size_t count, double deviation, std::uint64_t seed) {
    synthetic::Rng rng(seed);
    std::vector<Eigen::Vector3d> positions;
    for (std::size_t k = 0; k < count; ++k) {
        const Eigen::Vector3d off = deviation * rng.normal3();
        positions.emplace_back(
            (static_cast<double>(k) + 0.3 * rng.uniform()) / static_cast<double>(count), off.y(),
            off.z());
    }
    return positions;
}

/// Replaces a part of the directions by any others.
inline void plant_random_outliers(PlantedDirections& planted, double fraction, std::uint64_t seed) {
    synthetic::Rng rng(seed);
    for (std::size_t e = 0; e < planted.edges.size(); ++e) {
        if (rng.uniform() >= fraction) continue;
        planted.edges[e].direction = rng.direction();
        planted.wrong[e] = true;
    }
}

/// Mutually consistent outliers: the edges between two nodes of the first `nodes` stay, and of
/// their edges to others a part says that these nodes stand elsewhere, all shifted alike.
inline void plant_shifted_nodes(PlantedDirections& planted, std::uint32_t nodes, double fraction,
                                const Eigen::Vector3d& shift, std::uint64_t seed) {
    synthetic::Rng rng(seed);
    for (std::size_t e = 0; e < planted.edges.size(); ++e) {
        RelativeDirection& edge = planted.edges[e];
        if (edge.i >= nodes || edge.j < nodes || rng.uniform() >= fraction) continue;
        edge.direction =
            (planted.positions[edge.j] - planted.positions[edge.i] - shift).normalized();
        planted.wrong[e] = true;
    }
}

/// Largest distance from the truth of those that have a place, after the best similarity; infinite
/// when fewer than two do.
inline double max_position_error(std::span<const std::optional<Eigen::Vector3d>> estimated,
                                 std::span<const Eigen::Vector3d> truth) {
    std::vector<Eigen::Vector3d> source;
    std::vector<Eigen::Vector3d> target;
    for (std::size_t k = 0; k < truth.size(); ++k) {
        if (!estimated[k]) continue;
        source.push_back(*estimated[k]);
        target.push_back(truth[k]);
    }
    if (source.size() < 2) return std::numeric_limits<double>::infinity();
    const Sim3 aligned = synthetic::align_points(source, target, Eigen::Quaterniond::Identity());
    double worst = 0.0;
    for (std::size_t k = 0; k < source.size(); ++k) {
        worst = std::max(worst, (aligned * source[k] - target[k]).norm());
    }
    return worst;
}

}  // namespace psfm
