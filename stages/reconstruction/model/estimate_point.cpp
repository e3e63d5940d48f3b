// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/model/estimate_point.h"

#include <algorithm>
#include <array>
#include <tuple>

#include "stages/algorithms/math/angles.h"
#include "stages/algorithms/pose/triangulation.h"

namespace psfm {
namespace {

using Feature = WorkingModel::Feature;
constexpr std::size_t kPairsFrom = 20;  // Guard: bounds the pairs tried for one point

View view_of(const WorkingModel& model, const Feature& feature) {
    return {model.pose(feature.image), model.normalized(feature)};
}

/// The best observation of each image within the error bound, ascending by image.
std::vector<Feature> inliers_of(const WorkingModel& model, std::span<const Feature> candidates,
                                const Eigen::Vector3d& position, double max_squared_error) {
    struct Scored {
        Feature feature;
        double error;
    };
    std::vector<Scored> scored;
    for (const Feature& feature : candidates) {
        const double error = model.squared_error(feature, position);
        if (error <= max_squared_error) scored.push_back({feature, error});
    }
    std::ranges::sort(scored, [](const Scored& a, const Scored& b) {
        return std::tie(a.feature.image, a.error, a.feature.feature) <
               std::tie(b.feature.image, b.error, b.feature.feature);
    });
    std::vector<Feature> inliers;
    for (const Scored& s : scored) {
        if (inliers.empty() || inliers.back().image != s.feature.image)
            inliers.push_back(s.feature);
    }
    return inliers;
}

std::optional<Eigen::Vector3d> triangulate_track(const WorkingModel& model,
                                                 std::span<const Feature> track) {
    std::vector<View> views;
    views.reserve(track.size());
    for (const Feature& feature : track) views.push_back(view_of(model, feature));
    return triangulate(views);
}

}  // namespace

bool is_seen_from_apart(const WorkingModel& model, std::span<const Feature> track,
                        const Eigen::Vector3d& position, double min_angle) {
    // Images that arrived far from one another tend to stand far apart, and are tried first.
    for (std::size_t i = track.size(); i-- > 0;) {
        const Eigen::Vector3d centre = model.centre(track[i].image);
        for (std::size_t j = 0; j < i; ++j) {
            if (triangulation_angle(centre, model.centre(track[j].image), position) >= min_angle)
                return true;
        }
    }
    return false;
}

Result<void> validate(const TrackOptions& options) {
    if (!(options.max_error_px > 0) || !(options.min_angle_deg >= 0) ||
        options.completion_depth < 1) {
        return Error{ErrorCode::kInvalidArgument,
                     "tracks: error bound and depth must be positive, the angle not negative"};
    }
    return {};
}

std::optional<EstimatedPoint> estimate_point(const WorkingModel& model,
                                             std::span<const Feature> candidates,
                                             const TrackOptions& options) {
    const double max_squared_error = options.max_error_px * options.max_error_px;
    const double min_angle = options.min_angle_deg * kRadiansPerDegree;
    const std::size_t tried = std::min(candidates.size(), kPairsFrom);
    std::vector<View> views;
    views.reserve(tried);
    for (std::size_t i = 0; i < tried; ++i) views.push_back(view_of(model, candidates[i]));

    EstimatedPoint best;
    double best_angle = 0.0;
    for (std::size_t i = 0; i < tried; ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            if (candidates[i].image == candidates[j].image) continue;
            const std::array<View, 2> pair{views[j], views[i]};
            const auto position = triangulate(pair);
            if (!position) continue;
            const double angle = triangulation_angle(model.centre(candidates[i].image),
                                                     model.centre(candidates[j].image), *position);
            if (angle < min_angle) continue;
            std::vector<Feature> inliers =
                inliers_of(model, candidates, *position, max_squared_error);
            if (inliers.size() < 2) continue;
            if (inliers.size() > best.inliers.size() ||
                (inliers.size() == best.inliers.size() && angle > best_angle)) {
                best = {*position, std::move(inliers)};
                best_angle = angle;
            }
        }
        if (best.inliers.size() == candidates.size()) break;
    }
    if (best.inliers.size() < 2) return std::nullopt;
    if (best.inliers.size() > 2) {
        if (const auto refined = triangulate_track(model, best.inliers)) {
            std::vector<Feature> inliers =
                inliers_of(model, best.inliers, *refined, max_squared_error);
            if (inliers.size() == best.inliers.size()) best.position = *refined;
        }
    }
    return best;
}

}  // namespace psfm
