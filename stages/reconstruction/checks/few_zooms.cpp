// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/checks/few_zooms.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <ranges>
#include <set>
#include <utility>

#include "stages/algorithms/math/most_common.h"

namespace psfm {
namespace {

double certainty(const ReleasedCamera& camera) {
    // Guard: near the common focal length neither gain nor step says much
    constexpr double kLeastStep = 0.01;
    const double step = std::log(camera.own_focal_px / camera.tied_focal_px);
    const double gain = std::max(camera.tied_cost - camera.own_cost, 0.0);
    return gain * static_cast<double>(camera.observations) /
           (step * step + kLeastStep * kLeastStep);
}

/// Weighted sums over the first cameras, of which any run's variation follows.
struct Sums {
    double weight = 0.0, value = 0.0, square = 0.0;
};

/// How much the cameras of a run vary: the weighted sum of squares about their mean.
double variation(const Sums& before, const Sums& after) {
    const double weight = after.weight - before.weight;
    const double value = after.value - before.value;
    return weight > 0.0 ? after.square - before.square - value * value / weight : 0.0;
}

std::vector<Sums> sums_of(std::span<const ReleasedCamera> cameras,
                          const std::vector<std::size_t>& order) {
    std::vector<Sums> sums(1);
    for (const std::size_t camera : order) {
        const double weight = certainty(cameras[camera]);
        const double value = std::log(cameras[camera].own_focal_px);
        const Sums& before = sums.back();
        sums.push_back({before.weight + weight, before.value + weight * value,
                        before.square + weight * value * value});
    }
    return sums;
}

using Zooms = std::map<CameraId, std::size_t>;

CameraTies ties_with(const Zooms& zooms, Zooms labels, const ClusterProblem& problem) {
    std::size_t next = 0;
    for (const auto& [camera, label] : labels) next = std::max(next, label + 1);
    for (const auto& [camera, zoom] : zooms) labels[camera] = next + zoom;
    return ties_of(labels, problem);
}

std::size_t count_of(const Zooms& zooms) {
    std::set<std::size_t> values;
    for (const auto& [camera, zoom] : zooms) values.insert(zoom);
    return values.size();
}

/// The lens of each zoom in a model that was adjusted with them, as far as the model has images of
/// it.
std::vector<Camera> lenses_of(const Reconstruction& model, const ClusterProblem& problem,
                              const Zooms& zooms) {
    std::map<std::size_t, Camera> lenses;
    for (const ClusterImage& image : problem.images) {
        const auto zoom = zooms.find(image.camera);
        const RegisteredImage* placed = model.find(image.id);
        if (zoom != zooms.end() && placed != nullptr)
            lenses.try_emplace(zoom->second, model.cameras.at(placed->camera));
    }
    std::vector<Camera> by_zoom;
    by_zoom.reserve(lenses.size());
    for (const auto& [zoom, lens] : lenses) by_zoom.push_back(lens);
    return by_zoom;
}

/// The zoom with which each camera's images cost least, the most common one where they hardly tell.
Zooms best_zooms(const TiedModel& with, const ClusterProblem& problem, const Zooms& zooms,
                 const TieOptions& options) {
    std::vector<CameraId> cameras;
    for (const auto& [camera, zoom] : zooms) cameras.push_back(camera);
    const std::vector<Camera> lenses = lenses_of(*with.model, problem, zooms);
    if (lenses.size() < count_of(zooms)) return zooms;  // of one that is not there nothing is known
    const std::size_t common = most_common(zooms | std::views::values).first;
    Zooms best = zooms;
    for (const auto& [camera, costs] :
         costs_by_lens(with.model, problem, cameras, lenses, options)) {
        const auto least = std::ranges::min_element(costs);
        if (!std::isfinite(*least)) continue;
        const bool is_sure = costs[common] > options.min_zoom_gain * *least;
        best.at(camera) = is_sure ? static_cast<std::size_t>(least - costs.begin()) : common;
    }
    return best;
}

/// The same zooms, numbered from 0 on without gaps.
Zooms numbered(Zooms zooms) {
    std::map<std::size_t, std::size_t> numbers;
    for (const auto& [camera, zoom] : zooms) numbers.emplace(zoom, 0);
    std::size_t next = 0;
    for (auto& [zoom, number] : numbers) number = next++;
    for (auto& [camera, zoom] : zooms) zoom = numbers.at(zoom);
    return zooms;
}

/// Which of some zooms each camera has; those that deviate from it have one of their own.
Zooms settle_zooms(Zooms zooms, const TiedModel& apart, const ClusterProblem& problem,
                   const Zooms& labels, const TieOptions& options) {
    TiedModel with =
        adjust_tied(apart.model, problem, ties_with(zooms, labels, problem), 1, options);
    if (!with.model) return {};
    Zooms better = numbered(best_zooms(with, problem, zooms, options));
    if (better != zooms) {
        zooms = std::move(better);
        with = adjust_tied(apart.model, problem, ties_with(zooms, labels, problem), 1, options);
        if (!with.model) return {};
    }
    const Kinds kinds = compare_ties(with, apart, problem, options);
    const auto compared = kinds.find(problem.alike.at(zooms.begin()->first));
    if (compared == kinds.end()) return {};
    std::size_t next = count_of(zooms);
    for (const ReleasedCamera& camera : compared->second) {
        const auto zoom = zooms.find(camera.camera);  // these may be more than were asked about
        if (camera.deviates && zoom != zooms.end()) zoom->second = next++;
    }
    return numbered(std::move(zooms));
}

}  // namespace

std::map<CameraId, std::size_t> find_zooms(std::span<const ReleasedCamera> cameras,
                                           const TiedModel& apart, const ClusterProblem& problem,
                                           const std::map<CameraId, std::size_t>& labels,
                                           const TieOptions& options) {
    Zooms best;
    // What leaves every camera to itself explains nothing.
    std::size_t fewest = cameras.size() / 2 + 1;
    for (std::size_t count = 2; count <= options.max_zooms && count < fewest; ++count) {
        const std::vector<std::size_t> zoom_of = part_by_zoom(cameras, count);
        Zooms zooms;
        for (std::size_t i = 0; i < zoom_of.size(); ++i)
            zooms.emplace(cameras[i].camera, zoom_of[i]);
        if (zooms.empty()) break;
        zooms = settle_zooms(std::move(zooms), apart, problem, labels, options);
        // More of them would explain what fewer do not: then they do so one by one.
        if (zooms.empty() || count_of(zooms) >= fewest) break;
        fewest = count_of(zooms);
        best = std::move(zooms);
    }
    return best;
}

std::vector<std::size_t> part_by_zoom(std::span<const ReleasedCamera> cameras, std::size_t zooms) {
    const std::size_t n = cameras.size();
    if (n < zooms) return {};
    std::vector<std::size_t> order(n);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return cameras[i].own_focal_px; });
    const std::vector<Sums> sums = sums_of(cameras, order);
    // Dynamic programming: of the first `end` cameras in k + 1 parts, the least variation, and
    // where the last of these parts begins.
    using Best = std::pair<double, std::size_t>;
    std::vector<std::vector<Best>> best(
        zooms, std::vector<Best>(n + 1, {std::numeric_limits<double>::infinity(), 0}));
    for (std::size_t end = 1; end <= n; ++end) best[0][end] = {variation(sums[0], sums[end]), 0};
    for (std::size_t k = 1; k < zooms; ++k) {
        for (std::size_t end = k + 1; end <= n; ++end) {
            for (std::size_t first = k; first < end; ++first) {
                const double varies = best[k - 1][first].first + variation(sums[first], sums[end]);
                best[k][end] = std::min(best[k][end], Best(varies, first));
            }
        }
    }
    std::vector<std::size_t> zoom_of(n);
    for (std::size_t k = zooms, end = n; k-- > 0;) {
        const std::size_t first = best[k][end].second;
        for (std::size_t i = first; i < end; ++i) zoom_of[order[i]] = k;
        end = first;
    }
    return zoom_of;
}

}  // namespace psfm
