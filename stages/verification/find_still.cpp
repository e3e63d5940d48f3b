// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/verification/find_still.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <set>

#include "stages/algorithms/math/angles.h"
#include "stages/algorithms/math/median.h"

namespace psfm {
namespace {

/// @param side  squares along each side
std::size_t square_of(const Keypoint& keypoint, const Camera& camera, std::size_t side) {
    const auto along = [&](double position, std::uint32_t size) {
        const double part = std::clamp(position / size, 0.0, 1.0);
        return std::min(side - 1, static_cast<std::size_t>(part * static_cast<double>(side)));
    };
    return side * along(keypoint.y, camera.height) + along(keypoint.x, camera.width);
}

std::vector<std::size_t> features_by_square(std::span<const Keypoint> keypoints,
                                            const Camera& camera, std::size_t side) {
    std::vector<std::size_t> counts(side * side, 0);
    for (const Keypoint& keypoint : keypoints) ++counts[square_of(keypoint, camera, side)];
    return counts;
}

/// Between two orientations [rad], 0 to pi.
double turn(double a, double b) {
    return std::abs(std::remainder(a - b, 2.0 * std::numbers::pi));
}

bool of_one_size(const MatchedViews& views) {
    return views.camera1.width == views.camera2.width &&
           views.camera1.height == views.camera2.height;
}

/// From the first photograph's pixels to the second's. Programs put watermarks where a corner, a
/// side's middle or the photograph's is.
std::vector<Eigen::Vector2d> shifts_of_what_stands_still(const MatchedViews& views) {
    if (of_one_size(views)) return {Eigen::Vector2d::Zero()};
    const auto size_of = [](const Camera& camera) -> Eigen::Vector2d {
        return {camera.width, camera.height};
    };
    const Eigen::Vector2d wider = size_of(views.camera2) - size_of(views.camera1);
    std::vector<Eigen::Vector2d> shifts;
    for (const double across : {0.0, 0.5, 1.0}) {
        for (const double down : {0.0, 0.5, 1.0})
            shifts.emplace_back(across * wider.x(), down * wider.y());
    }
    return shifts;
}

std::vector<FeatureMatch> matches_at(const MatchedViews& views, const Eigen::Vector2d& shift,
                                     const StillOptions& options) {
    const double longer_side = std::max(views.camera1.width, views.camera1.height);
    const double reach = options.max_motion_px * std::max(1.0, longer_side / options.exact_side_px);
    std::vector<FeatureMatch> found;
    for (const FeatureMatch& match : views.matches) {
        const Keypoint& first = views.keypoints1[match.first];
        const Keypoint& second = views.keypoints2[match.second];
        if ((first.position() + shift - second.position()).norm() > reach) continue;
        const auto [small, large] = std::minmax(first.scale, second.scale);
        if (double{large} > options.max_scale_ratio * small) continue;
        if (turn(first.angle, second.angle) > radians_from_degrees(options.max_turn_deg)) continue;
        found.push_back(match);
    }
    return found;
}

}  // namespace

std::vector<FeatureMatch> find_still(const MatchedViews& views, const StillOptions& options) {
    if (options.min_matches == 0) return {};
    std::vector<FeatureMatch> still;
    for (const Eigen::Vector2d& shift : shifts_of_what_stands_still(views)) {
        std::vector<FeatureMatch> here = matches_at(views, shift, options);
        if (here.size() > still.size()) still = std::move(here);
    }
    std::ranges::sort(still);
    std::vector<FeatureMatch> once;
    std::set<std::uint32_t> first;
    std::set<std::uint32_t> second;
    std::ranges::copy_if(still, std::back_inserter(once), [&](const FeatureMatch& match) {
        return !first.contains(match.first) && !second.contains(match.second) &&
               first.insert(match.first).second && second.insert(match.second).second;
    });
    if (once.size() < options.min_matches) once.clear();
    return once;
}

double still_coverage(const MatchedViews& views, std::span<const FeatureMatch> still,
                      const StillOptions& options) {
    if (!of_one_size(views)) return 0.0;
    const std::size_t side = options.coverage_grid;
    const auto first = features_by_square(views.keypoints1, views.camera1, side);
    const auto second = features_by_square(views.keypoints2, views.camera2, side);
    std::vector<bool> holds(side * side, false);
    for (const FeatureMatch& match : still)
        holds[square_of(views.keypoints1[match.first], views.camera1, side)] = true;
    std::size_t all = 0;
    std::size_t covered = 0;
    for (std::size_t square = 0; square < holds.size(); ++square) {
        // What only one of them shows there has come or gone, and says nothing of the other.
        const std::size_t features = std::min(first[square], second[square]);
        all += features;
        if (holds[square]) covered += features;
    }
    return all == 0 ? 0.0 : static_cast<double>(covered) / static_cast<double>(all);
}

double median_motion_px(const MatchedViews& views, std::span<const FeatureMatch> matches) {
    if (matches.empty()) return 0.0;
    std::vector<double> motions;
    motions.reserve(matches.size());
    for (const FeatureMatch& match : matches) {
        motions.push_back(
            (views.keypoints1[match.first].position() - views.keypoints2[match.second].position())
                .norm());
    }
    return upper_median(std::move(motions));
}

}  // namespace psfm
