// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/tracks.h"

#include <algorithm>
#include <numbers>
#include <optional>
#include <set>

namespace psfm {
namespace {

using Feature = WorkingModel::Feature;
constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;

/// The point among those of a feature's matches that explains the feature best, within the error
/// bound.
std::optional<std::uint32_t> best_point_for(const WorkingModel& model, const Feature& feature,
                                            double max_squared_error) {
    std::optional<std::uint32_t> best;
    double best_error = max_squared_error;
    for (const Feature& match : model.matches().matches(feature)) {
        const std::uint32_t point = model.point_of(match);
        if (point == WorkingModel::kNoPoint || best == point) continue;
        const std::vector<Feature>& track = model.points()[point].track;
        const bool taken =
            std::ranges::any_of(track, [&](const Feature& f) { return f.image == feature.image; });
        if (taken) continue;
        const double error = model.squared_error(feature, model.points()[point].position);
        if (error < best_error) {
            best = point;
            best_error = error;
        }
    }
    return best;
}

/// The feature itself and its matches in registered images that observe nothing yet, ascending.
std::vector<Feature> free_matches(const WorkingModel& model, const Feature& feature) {
    std::vector<Feature> candidates{feature};
    for (const Feature& match : model.matches().matches(feature)) {
        if (model.registered(match.image) && model.point_of(match) == WorkingModel::kNoPoint) {
            candidates.push_back(match);
        }
    }
    std::ranges::sort(candidates);
    return candidates;
}

/// Follows matches from a point's observations and adds what fits. @return observations added
std::size_t complete_track(WorkingModel& model, std::uint32_t point, const TrackOptions& options) {
    const double max_squared_error = options.max_error_px * options.max_error_px;
    std::vector<Feature> frontier = model.points()[point].track;
    std::size_t added = 0;
    for (int depth = 0; depth < options.completion_depth && !frontier.empty(); ++depth) {
        std::vector<Feature> next;
        for (const Feature& feature : frontier) {
            for (const Feature& match : model.matches().matches(feature)) {
                if (!model.registered(match.image) ||
                    model.point_of(match) != WorkingModel::kNoPoint)
                    continue;
                if (model.squared_error(match, model.points()[point].position) > max_squared_error)
                    continue;
                if (model.add_observation(point, match)) next.push_back(match);
            }
        }
        added += next.size();
        frontier = std::move(next);
    }
    return added;
}

/// Position of two joined points by their numbers of observations, when all of these agree with it.
std::optional<Eigen::Vector3d> joint_position(const WorkingModel& model,
                                              const WorkingModel::Point& a,
                                              const WorkingModel::Point& b,
                                              double max_squared_error) {
    const auto weight_a = static_cast<double>(a.track.size());
    const auto weight_b = static_cast<double>(b.track.size());
    const Eigen::Vector3d position =
        (weight_a * a.position + weight_b * b.position) / (weight_a + weight_b);
    std::set<std::uint32_t> images;
    for (const WorkingModel::Point* point : {&a, &b}) {
        for (const Feature& feature : point->track) {
            if (!images.insert(feature.image).second) return std::nullopt;
            if (model.squared_error(feature, position) > max_squared_error) return std::nullopt;
        }
    }
    return position;
}

}  // namespace

std::vector<std::uint32_t> points_seen_by(const WorkingModel& model,
                                          std::span<const std::uint32_t> images) {
    std::vector<std::uint32_t> points;
    for (std::uint32_t point = 0; images.empty() && point < model.points().size(); ++point) {
        if (model.points()[point].alive()) points.push_back(point);
    }
    for (const std::uint32_t image : images) {
        for (std::uint32_t index = 0; index < model.matches().feature_count(image); ++index) {
            const std::uint32_t point = model.point_of({image, index});
            if (point != WorkingModel::kNoPoint) points.push_back(point);
        }
    }
    std::ranges::sort(points);
    points.erase(std::unique(points.begin(), points.end()), points.end());
    return points;
}

std::size_t triangulate_image(WorkingModel& model, std::uint32_t image,
                              const TrackOptions& options) {
    const double max_squared_error = options.max_error_px * options.max_error_px;
    std::size_t added = 0;
    for (std::uint32_t index = 0; index < model.matches().feature_count(image); ++index) {
        const Feature feature{image, index};
        if (model.matches().matches(feature).empty()) continue;
        if (model.point_of(feature) == WorkingModel::kNoPoint) {
            if (const auto point = best_point_for(model, feature, max_squared_error)) {
                if (model.add_observation(*point, feature)) ++added;
            }
        }
        if (model.point_of(feature) != WorkingModel::kNoPoint) continue;
        std::vector<Feature> candidates = free_matches(model, feature);
        while (candidates.size() >= 2) {
            const auto estimated = estimate_point(model, candidates, options);
            if (!estimated) break;
            model.add_point(estimated->position, estimated->inliers);
            added += estimated->inliers.size();
            std::erase_if(candidates, [&](const Feature& f) {
                return std::ranges::binary_search(estimated->inliers, f);
            });
        }
    }
    return added;
}

std::size_t complete_tracks(WorkingModel& model, std::span<const std::uint32_t> images,
                            const TrackOptions& options) {
    std::size_t added = 0;
    for (const std::uint32_t point : points_seen_by(model, images))
        added += complete_track(model, point, options);
    return added;
}

std::size_t merge_tracks(WorkingModel& model, std::span<const std::uint32_t> images,
                         const TrackOptions& options) {
    const double max_squared_error = options.max_error_px * options.max_error_px;
    std::size_t merged = 0;
    std::vector<bool> done(model.points().size(), false);
    for (const std::uint32_t point : points_seen_by(model, images)) {
        done[point] = true;
        if (!model.points()[point].alive()) continue;
        std::set<std::uint32_t> connected;
        for (const Feature& feature : model.points()[point].track) {
            for (const Feature& match : model.matches().matches(feature)) {
                const std::uint32_t other = model.point_of(match);
                if (other != WorkingModel::kNoPoint && !done[other]) connected.insert(other);
            }
        }
        for (const std::uint32_t other : connected) {
            const WorkingModel::Point& a = model.points()[point];
            const WorkingModel::Point& b = model.points()[other];
            const auto position = joint_position(model, a, b, max_squared_error);
            if (!position) continue;
            const std::vector<Feature> moved = b.track;
            model.remove_point(other);
            for (const Feature& feature : moved) model.add_observation(point, feature);
            model.set_position(point, *position);
            merged += moved.size();
        }
    }
    return merged;
}

std::size_t filter_tracks(WorkingModel& model, std::span<const std::uint32_t> images,
                          const TrackOptions& options) {
    const double max_squared_error = options.max_error_px * options.max_error_px;
    const double min_angle = options.min_angle_deg * kRadiansPerDegree;
    std::size_t removed = 0;
    std::vector<Feature> bad;
    std::vector<bool> is_looked_at(model.image_count(), images.empty());
    for (const std::uint32_t image : images) is_looked_at[image] = true;
    for (const std::uint32_t point : points_seen_by(model, images)) {
        const std::vector<Feature>& track = model.points()[point].track;
        const bool changed = !model.points()[point].error_px;
        const std::size_t observations = track.size();
        bad.clear();
        for (const Feature& feature : track) {
            if (!changed && !is_looked_at[feature.image]) continue;
            if (model.squared_error(feature, model.points()[point].position) > max_squared_error)
                bad.push_back(feature);
        }
        if (bad.empty() && !changed && !images.empty()) continue;
        if (observations - bad.size() < 2) {
            model.remove_point(point);
            removed += observations;
            continue;
        }
        for (const Feature& feature : bad) model.remove_observation(feature);
        removed += bad.size();
        if (!is_seen_from_apart(model, model.points()[point].track, model.points()[point].position,
                                min_angle)) {
            removed += model.points()[point].track.size();
            model.remove_point(point);
        }
    }
    return removed;
}

}  // namespace psfm
