// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/synthetic/look_alikes/facade.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace psfm::synthetic {
namespace {

/// From further to the side nothing is detected.
constexpr double kMaxSlantDeg = 78.0;

double tangent_of(double degrees) {
    return std::tan(degrees * std::numbers::pi / 180.0);
}

FacadePoint draw_point(const FacadeOptions& options, Rng& rng) {
    FacadePoint point;
    const double x = rng.uniform(-0.5, 0.5) * options.width;
    const double y = options.relief * rng.normal();
    const double z = rng.uniform(0.0, options.height);
    point.in_facade = {x, y, z};
    const double range_deg =
        std::min(-options.mean_range_deg * std::log(1.0 - rng.uniform()), options.max_range_deg);
    const double side_deg = kMaxSlantDeg - 0.5 * range_deg;
    const double middle_deg = rng.uniform(-side_deg, side_deg);
    point.from_tangent = tangent_of(middle_deg - 0.5 * range_deg);
    point.to_tangent = tangent_of(middle_deg + 0.5 * range_deg);
    const double distance =
        options.nearest * std::pow(options.farthest / options.nearest, rng.uniform());
    point.from_distance = distance / options.scale_range;
    point.to_distance = distance * options.scale_range;
    return point;
}

void add_points(const FacadeDesign& points, const std::vector<std::uint32_t>& looks,
                std::uint32_t place, Facade& facade, LookAlikeBuilder& builder) {
    const Eigen::Vector3d normal = facade.world_from_facade.rotation * Eigen::Vector3d::UnitY();
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Eigen::Vector3d position = facade.world_from_facade * points[i].in_facade;
        facade.points.push_back(points[i]);
        facade.indices.push_back(builder.add_point({position, normal}, looks[i], place));
    }
}

}  // namespace

FacadeDesign draw_facade(const FacadeOptions& options, double part, Rng& rng) {
    FacadeDesign points;
    for (auto left = std::llround(options.points_per_metre * options.width * part); left > 0;
         --left) {
        points.push_back(draw_point(options, rng));
    }
    return points;
}

Rigid3 world_from_facade(const Eigen::Vector3d& foot, const Eigen::Vector3d& normal) {
    Eigen::Matrix3d axes;
    axes.col(0) = normal.cross(Eigen::Vector3d::UnitZ());
    axes.col(1) = normal;
    axes.col(2) = Eigen::Vector3d::UnitZ();
    return {Eigen::Quaterniond(axes).normalized(), foot};
}

SharedDesign share(FacadeDesign points, LookAlikeBuilder& builder) {
    SharedDesign shared{std::move(points), {}};
    while (shared.looks.size() < shared.points.size()) shared.looks.push_back(builder.add_look());
    return shared;
}

Facade build_facade(const FacadeOptions& options, const Rigid3& world_from_facade,
                    const FacadeDesign& own, const SharedDesign* shared,
                    LookAlikeBuilder& builder) {
    Facade facade;
    facade.world_from_facade = world_from_facade;
    facade.half_width = 0.5 * options.width;
    facade.reach = options.farthest * options.scale_range;
    std::vector<std::uint32_t> looks;
    while (looks.size() < own.size()) looks.push_back(builder.add_look());
    add_points(own, looks, kNoPlace, facade, builder);
    if (shared != nullptr) {
        const std::uint32_t place = builder.add_place(world_from_facade);
        add_points(shared->points, shared->looks, place, facade, builder);
    }
    return facade;
}

void observe_facade(const Facade& facade, ImageId image, const Eigen::Vector3d& centre,
                    const std::function<bool(const Eigen::Vector3d& point)>& hidden,
                    LookAlikeBuilder& builder) {
    const Eigen::Vector3d in_facade = inverse(facade.world_from_facade) * centre;
    const double beside = std::max(0.0, std::abs(in_facade.x()) - facade.half_width);
    if (in_facade.y() <= 0.0 || std::hypot(beside, in_facade.y()) > facade.reach) return;
    for (std::size_t i = 0; i < facade.points.size(); ++i) {
        const FacadePoint& point = facade.points[i];
        const Eigen::Vector3d to_camera = in_facade - point.in_facade;
        if (to_camera.x() < point.from_tangent * to_camera.y() ||
            to_camera.x() > point.to_tangent * to_camera.y() || to_camera.y() <= 0.0) {
            continue;
        }
        const double distance = to_camera.norm();
        if (distance < point.from_distance || distance > point.to_distance) continue;
        if (hidden && hidden(facade.world_from_facade * point.in_facade)) continue;
        builder.observe(image, facade.indices[i]);
    }
}

}  // namespace psfm::synthetic
