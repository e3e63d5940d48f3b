// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/merge/geo/georeference.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "stages/algorithms/alignment/estimate_sim3.h"
#include "stages/algorithms/math/cauchy.h"
#include "stages/algorithms/math/decompositions.h"

namespace psfm {
namespace {

/// Guard: proposals are judged on so many cameras at most, spread over all of them.
constexpr std::size_t kJudges = 500;
/// Guard: draws for one sample before it is given up: photographs taken in one place say nothing.
constexpr int kDraws = 20;

bool is_inlier(const LocatedCamera& camera, const Sim3& sim, const GeoreferenceOptions& options) {
    const Eigen::Vector3d difference = sim * camera.centre - camera.enu;
    return difference.head<2>().norm() <= options.inlier_sigmas * options.horizontal_sigma_m &&
           (!camera.has_altitude ||
            std::abs(difference.z()) <= options.inlier_sigmas * options.vertical_sigma_m);
}

/// Heading, scale and shift of a component that stands upright already.
std::optional<Sim3> from_pair(const LocatedCamera& one, const LocatedCamera& two,
                              const Eigen::Quaterniond& upright, double min_distance) {
    const Eigen::Vector2d from = (upright * (two.centre - one.centre)).head<2>();
    const Eigen::Vector2d to = (two.enu - one.enu).head<2>();
    if (!(from.norm() > 0.0) || to.norm() < min_distance) return std::nullopt;
    const double heading =
        std::atan2(from.x() * to.y() - from.y() * to.x(), from.x() * to.x() + from.y() * to.y());
    Sim3 sim;
    sim.scale = to.norm() / from.norm();
    sim.rotation = (Eigen::AngleAxisd(heading, Eigen::Vector3d::UnitZ()) * upright).normalized();
    sim.translation =
        0.5 * (one.enu + two.enu) - sim.scale * (sim.rotation * (0.5 * (one.centre + two.centre)));
    return sim;
}

std::optional<Sim3> from_triple(const std::array<const LocatedCamera*, 3>& cameras,
                                double min_distance) {
    std::array<Eigen::Vector3d, 3> from;
    std::array<Eigen::Vector3d, 3> to;
    for (std::size_t k = 0; k < 3; ++k) {
        from.at(k) = cameras.at(k)->centre;
        to.at(k) = cameras.at(k)->enu;
    }
    for (std::size_t k = 0; k < 3; ++k) {
        if ((to.at(k) - to.at((k + 1) % 3)).head<2>().norm() < min_distance) return std::nullopt;
    }
    const auto sim = estimate_sim3(from, to);
    if (!sim.ok()) return std::nullopt;  // Expected: positions on a line give no frame
    return *sim;
}

/// The best proposal, refined.
class Search {
  public:
    Search(std::span<const LocatedCamera> cameras, const GeoreferenceOptions& options)
        : cameras_(cameras), options_(options), random_(cameras.size()) {
        const std::size_t count = std::min(cameras.size(), kJudges);
        for (std::size_t k = 0; k < count; ++k)
            judges_.push_back(cameras[k * cameras.size() / count]);
    }

    void consider(const Sim3& sim, const Gravity* gravity) {
        const double cost = position_cost(judges_, gravity, sim, options_);
        if (cost >= best_cost_) return;
        best_cost_ = cost;
        best_ = sim;
    }

    void draw_pairs(const Gravity& gravity, const Eigen::Vector3d& up) {
        const Eigen::Quaterniond upright = rotation_between(up, Eigen::Vector3d::UnitZ());
        draw(
            [&] {
                const LocatedCamera& one = any();
                return from_pair(one, any(), upright, far_apart());
            },
            &gravity);
    }

    void draw_triples() {
        draw([&] { return from_triple({&any(), &any(), &any()}, far_apart()); }, nullptr);
    }

    std::optional<Sim3> refined(const Gravity* gravity) const {
        if (!best_) return std::nullopt;
        return fit_to_positions(cameras_, gravity, *best_, options_);
    }

  private:
    const LocatedCamera& any() { return cameras_[random_() % cameras_.size()]; }
    double far_apart() const { return 2.0 * options_.horizontal_sigma_m; }

    template <typename Propose>
    void draw(const Propose& propose, const Gravity* gravity) {
        for (std::uint32_t sample = 0; sample < options_.samples; ++sample) {
            for (int trial = 0; trial < kDraws; ++trial) {
                const auto sim = propose();
                if (!sim) continue;
                consider(*sim, gravity);
                break;
            }
        }
    }

    std::span<const LocatedCamera> cameras_;
    const GeoreferenceOptions& options_;
    std::mt19937_64 random_;
    std::vector<LocatedCamera> judges_;
    std::optional<Sim3> best_;
    double best_cost_ = std::numeric_limits<double>::infinity();
};

Error too_little(const std::string& why) {
    return {ErrorCode::kDegenerate, "georeference: " + why};
}

/// Whether the cameras, as they stand, spread across the line that fits them best.
bool spread_in_a_plane(std::span<const LocatedCamera> cameras, const Sim3& sim,
                       const GeoreferenceOptions& options) {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const LocatedCamera& camera : cameras) mean += sim * camera.centre;
    mean /= static_cast<double>(cameras.size());
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    for (const LocatedCamera& camera : cameras) {
        if (!is_inlier(camera, sim, options)) continue;
        const Eigen::Vector3d arm = sim * camera.centre - mean;
        scatter += arm * arm.transpose();
    }
    return eigensystem(scatter).values[1] >=
           squared(options.horizontal_sigma_m / options.max_heading_sigma);
}

double extent_of(std::span<const Eigen::Vector2d> places) {
    const auto farthest_from = [&](const Eigen::Vector2d& from) {
        return *std::ranges::max_element(
            places, {}, [&](const Eigen::Vector2d& place) { return (place - from).squaredNorm(); });
    };
    const Eigen::Vector2d end = farthest_from(places.front());
    return (farthest_from(end) - end).norm();
}

}  // namespace

std::optional<LocatedCamera> locate(const Eigen::Vector3d& centre, const ImageEvidence& evidence,
                                    const GpsPosition& datum) {
    if (!evidence.gps || !is_plausible(*evidence.gps)) return std::nullopt;
    return LocatedCamera{centre, enu_from_wgs84(datum, *evidence.gps),
                         evidence.gps->altitude_m.has_value()};
}

PositionAgreement agreement(std::span<const LocatedCamera> cameras, const Sim3& enu_from_component,
                            const GeoreferenceOptions& options) {
    PositionAgreement result;
    result.positions = static_cast<std::uint32_t>(cameras.size());
    std::vector<double> distances;
    std::vector<Eigen::Vector2d> places;
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    for (const LocatedCamera& camera : cameras) {
        const Eigen::Vector3d place = enu_from_component * camera.centre;
        distances.push_back((place - camera.enu).head<2>().norm());
        if (!is_inlier(camera, enu_from_component, options)) continue;
        places.emplace_back(place.head<2>());
        mean += place.head<2>();
    }
    result.inliers = static_cast<std::uint32_t>(places.size());
    result.heading_sigma = std::numeric_limits<double>::infinity();
    if (!places.empty()) {
        const auto count = static_cast<double>(places.size());
        mean /= count;
        double spread = 0.0;
        for (const Eigen::Vector2d& place : places) spread += (place - mean).squaredNorm();
        result.heading_sigma = options.horizontal_sigma_m / std::sqrt(spread);
        result.standard_error_m = 2.0 * options.horizontal_sigma_m / std::sqrt(count);
        result.extent_m = extent_of(places);
    }
    if (!distances.empty()) {
        std::ranges::sort(distances);
        result.median_m = distances[distances.size() / 2];
        result.max_m = distances.back();
    }
    return result;
}

bool PositionAgreement::is_enough(const GeoreferenceOptions& options) const {
    return positions >= options.min_positions && inliers >= options.min_positions &&
           inliers >= options.min_inlier_ratio * positions &&
           heading_sigma <= options.max_heading_sigma &&
           extent_m >= options.horizontal_sigma_m / options.max_heading_sigma;
}

Result<Georeference> estimate_georeference(std::span<const LocatedCamera> cameras,
                                           const std::optional<Gravity>& gravity,
                                           const std::optional<Sim3>& before,
                                           const GeoreferenceOptions& options) {
    if (cameras.size() < options.min_positions) {
        return too_little(std::to_string(cameras.size()) + " positions, " +
                          std::to_string(options.min_positions) + " are needed");
    }
    PositionAgreement closest;
    if (gravity) {
        Search search(cameras, options);
        const bool upright = before && (before->rotation * gravity->up).z() > 0.0;
        if (before && (upright || !gravity->sign_known)) search.consider(*before, &*gravity);
        search.draw_pairs(*gravity, gravity->up);
        if (!gravity->sign_known) search.draw_pairs(*gravity, -gravity->up);
        if (const auto sim = search.refined(&*gravity)) {
            closest = agreement(cameras, *sim, options);
            if (closest.is_enough(options)) return Georeference{*sim, closest, true};
        }
    }
    Search search(cameras, options);
    if (before) search.consider(*before, nullptr);
    search.draw_triples();
    if (const auto sim = search.refined(nullptr)) {
        closest = agreement(cameras, *sim, options);
        if (closest.is_enough(options) && spread_in_a_plane(cameras, *sim, options))
            return Georeference{*sim, closest, false};
    }
    if (closest.inliers < options.min_inlier_ratio * closest.positions) {
        return too_little("only " + std::to_string(closest.inliers) + " of " +
                          std::to_string(closest.positions) + " positions agree");
    }
    return too_little("positions too close to one another, or on one line, for their error");
}

}  // namespace psfm
