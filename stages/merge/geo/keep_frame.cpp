// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/merge/geo/keep_frame.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <random>

#include "stages/algorithms/alignment/estimate_sim3.h"
#include "stages/algorithms/math/kd_tree.h"
#include "stages/algorithms/math/median.h"

namespace psfm {
namespace {

/// An image before and now.
struct Match {
    Rigid3 cam_from_component;
    Rigid3 cam_from_world;
    Eigen::Vector3d in_component;
    Eigen::Vector3d in_world;
};

/// Mathematics: random pairs of images that propose a similarity. Half of all images moved: 2^-2
/// for a good pair, so that 60 miss with a chance of 1e-7.
constexpr int kProposals = 60;
constexpr int kRefinements = 10;  // Guard: ends the loop
/// Guard: of more images every second, third, … is looked at: they tell a frame as well, and what a
/// new image costs does not grow with their number. Ours.
constexpr std::size_t kImagesLookedAt = 1000;

std::size_t stride_over(std::size_t images) {
    return std::max<std::size_t>(1, (images + kImagesLookedAt - 1) / kImagesLookedAt);
}

/// Summing ends where the cost is `limit` or more.
double cost_of(std::span<const Match> matches, const Sim3& world_from_component, double tolerance,
               double limit) {
    double cost = 0.0;
    for (const Match& match : matches) {
        const double moved = (world_from_component * match.in_component - match.in_world).norm();
        cost += std::min(moved / tolerance, 1.0);
        if (cost >= limit) break;
    }
    return cost;
}

/// From two images: orientation of the first, distance to the second.
std::optional<Sim3> from_pair(const Match& one, const Match& two) {
    const double now = (two.in_component - one.in_component).norm();
    const double before = (two.in_world - one.in_world).norm();
    if (!(now > 0.0 && before > 0.0)) return std::nullopt;
    Sim3 sim;
    sim.scale = before / now;
    sim.rotation =
        (one.cam_from_world.rotation.conjugate() * one.cam_from_component.rotation).normalized();
    sim.translation = one.in_world - sim.scale * (sim.rotation * one.in_component);
    return sim;
}

/// Reweighted least squares (Geman-McClure). Cameras on a line leave a turn about it open; then
/// three further points a camera, along its axes, tell it.
Sim3 refined(std::span<const Match> matches, Sim3 sim, double tolerance) {
    std::vector<Eigen::Vector3d> from;
    std::vector<Eigen::Vector3d> to;
    std::vector<double> weights;
    for (int step = 0; step < kRefinements; ++step) {
        for (const bool with_axes : {false, true}) {
            from.clear();
            to.clear();
            weights.clear();
            for (const Match& match : matches) {
                const double moved = (sim * match.in_component - match.in_world).norm() / tolerance;
                const double weight = 1.0 / ((1.0 + moved * moved) * (1.0 + moved * moved));
                from.push_back(match.in_component);
                to.push_back(match.in_world);
                weights.push_back(weight);
                for (int axis = 0; with_axes && axis < 3; ++axis) {
                    const Eigen::Vector3d tip = tolerance * Eigen::Vector3d::Unit(axis);
                    from.push_back(inverse(match.cam_from_component) * (tip / sim.scale));
                    to.push_back(inverse(match.cam_from_world) * tip);
                    weights.push_back(weight);
                }
            }
            const auto fitted = estimate_sim3(from, to, weights);
            if (!fitted.ok()) continue;  // Expected: too little stayed to hold the frame by
            sim = *fitted;
            break;
        }
    }
    return sim;
}

}  // namespace

std::unordered_map<ImageId, Rigid3> published_poses(const Scene& scene) {
    std::unordered_map<ImageId, Rigid3> poses;
    for (const auto& cluster : scene.clusters) {
        if (cluster->model == nullptr) continue;
        for (const RegisteredImage& image : cluster->model->images) {
            poses.try_emplace(image.image,
                              transform_pose(image.cam_from_cluster, cluster->world_from_cluster));
        }
    }
    return poses;
}

double median_neighbor_distance(std::span<const Eigen::Vector3d> centres) {
    if (centres.size() < 2) return 0.0;
    const KdTree tree(std::vector<Eigen::Vector3d>(centres.begin(), centres.end()));
    std::vector<double> distances;
    distances.reserve(centres.size());
    for (std::size_t k = 0; k < centres.size(); k += stride_over(centres.size())) {
        distances.push_back(tree.nearest_distance(centres[k], k));
    }
    return upper_median(std::move(distances));
}

Sim3 world_from_component(std::span<const PlacedImage> images,
                          const std::unordered_map<ImageId, Rigid3>& published,
                          std::span<const Sim3> candidates, const Sim3& fallback,
                          double max_stayed_move) {
    std::vector<Match> matches;
    std::vector<Eigen::Vector3d> before;
    const std::size_t stride = stride_over(images.size());
    for (const PlacedImage& image : images) {
        const auto found = published.find(image.image);
        if (found == published.end()) continue;
        before.push_back(found->second.target_origin_in_source());
        if ((before.size() - 1) % stride != 0) continue;
        matches.push_back({image.cam_from_component, found->second,
                           image.cam_from_component.target_origin_in_source(), before.back()});
    }
    if (matches.empty()) return fallback;
    const double spacing = median_neighbor_distance(before);
    const double tolerance = max_stayed_move * (spacing > 0.0 ? spacing : 1.0);

    std::optional<Sim3> best;
    double best_cost = std::numeric_limits<double>::infinity();
    const auto consider = [&](const Sim3& sim) {
        const double cost = cost_of(matches, sim, tolerance, best_cost);
        if (best && cost >= best_cost) return;
        best = sim;
        best_cost = cost;
    };
    for (const Sim3& candidate : candidates) consider(candidate);
    std::mt19937_64 random(matches.size());
    for (int k = 0; k < kProposals && matches.size() > 1; ++k) {
        const std::size_t one = random() % matches.size();
        const std::size_t two = random() % matches.size();
        if (const auto sim = from_pair(matches[one], matches[two])) consider(*sim);
    }
    if (!best) {
        // One image, or all in one place: their orientation, and the fallback's scale.
        Sim3 sim = fallback;
        sim.rotation = (matches.front().cam_from_world.rotation.conjugate() *
                        matches.front().cam_from_component.rotation)
                           .normalized();
        sim.translation =
            matches.front().in_world - sim.scale * (sim.rotation * matches.front().in_component);
        return sim;
    }
    // Guard: nothing moved: no rounding either.
    constexpr double kUnmoved = 1e-9;
    if (best_cost <= kUnmoved * static_cast<double>(matches.size())) return *best;
    consider(refined(matches, *best, tolerance));
    return *best;
}

}  // namespace psfm
