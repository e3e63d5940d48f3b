// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cmath>
#include <numbers>

#include "tests/synthetic/rng.h"
#include "tests/synthetic/scene.h"

namespace psfm::synthetic {
namespace {

/// A smooth random height field: a few plane waves of random direction and phase.
class Hills {
  public:
    Hills(double relief, double length, Rng& rng) : amplitude_(relief * std::sqrt(2.0 / kWaves)) {
        for (Wave& wave : waves_) {
            const double direction = rng.uniform(0.0, 2.0 * std::numbers::pi);
            const double per_metre = 2.0 * std::numbers::pi * rng.uniform(1.0, 3.0) / length;
            wave.frequency = per_metre * Eigen::Vector2d(std::cos(direction), std::sin(direction));
            wave.phase = rng.uniform(0.0, 2.0 * std::numbers::pi);
        }
    }

    double height(const Eigen::Vector2d& at) const {
        double sum = 0.0;
        for (const Wave& wave : waves_) sum += std::sin(wave.frequency.dot(at) + wave.phase);
        return amplitude_ * sum;
    }

    Eigen::Vector2d slope(const Eigen::Vector2d& at) const {
        Eigen::Vector2d sum = Eigen::Vector2d::Zero();
        for (const Wave& wave : waves_) {
            sum += std::cos(wave.frequency.dot(at) + wave.phase) * wave.frequency;
        }
        return amplitude_ * sum;
    }

  private:
    struct Wave {
        Eigen::Vector2d frequency;
        double phase = 0.0;
    };
    static constexpr std::size_t kWaves = 6;
    double amplitude_;
    std::array<Wave, kWaves> waves_;
};

SurfacePoint on_box_room(const Eigen::Vector3d& extent, Rng& rng) {
    // A face is drawn by its area, so that points are spread evenly.
    const Eigen::Vector3d area(extent.y() * extent.z(), extent.x() * extent.z(),
                               extent.x() * extent.y());
    const double choice = rng.uniform(0.0, area.sum());
    const int axis = choice < area.x() ? 0 : choice < area.x() + area.y() ? 1 : 2;
    SurfacePoint point;
    for (int i = 0; i < 3; ++i) point.position[i] = rng.uniform(-0.5, 0.5) * extent[i];
    const double side = rng.below(2) == 0 ? -1.0 : 1.0;
    point.position[axis] = 0.5 * side * extent[axis];
    point.normal = -side * Eigen::Vector3d::Unit(axis);
    return point;
}

}  // namespace

std::vector<SurfacePoint> make_points(const PointOptions& options, std::uint64_t seed) {
    Rng rng(mix_seed(seed, 1));
    const bool wall = options.surface == Surface::kReliefWall;
    const double length = wall ? std::max(options.extent.x(), options.extent.z())
                               : std::max(options.extent.x(), options.extent.y());
    const Hills hills(options.relief, length, rng);
    std::vector<SurfacePoint> points(options.count);
    for (SurfacePoint& point : points) {
        switch (options.surface) {
            case Surface::kBoxRoom:
                point = on_box_room(options.extent, rng);
                break;
            case Surface::kSphere:
                point.normal = rng.direction();
                point.position = 0.5 * options.extent.x() * point.normal;
                break;
            case Surface::kReliefWall:
            case Surface::kGround: {
                const double second = wall ? options.extent.z() : options.extent.y();
                const double u = rng.uniform(-0.5, 0.5) * options.extent.x();
                const double v = rng.uniform(-0.5, 0.5) * second;
                const double height = hills.height({u, v});
                const Eigen::Vector2d slope = hills.slope({u, v});
                point.position =
                    wall ? Eigen::Vector3d(u, -height, v) : Eigen::Vector3d(u, v, height);
                point.normal = wall ? Eigen::Vector3d(-slope.x(), -1.0, -slope.y())
                                    : Eigen::Vector3d(-slope.x(), -slope.y(), 1.0);
                point.normal.normalize();
                break;
            }
        }
    }
    return points;
}

}  // namespace psfm::synthetic
