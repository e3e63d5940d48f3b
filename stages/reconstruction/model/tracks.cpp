// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/model/tracks.h"

#include <algorithm>
#include <iterator>
#include <optional>

#include "graph/sorted_unique.h"
#include "stages/algorithms/math/angles.h"
#include "stages/algorithms/math/in_parallel.h"

namespace psfm {
namespace {

using Feature = WorkingModel::Feature;

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

/// Whether a feature is of a registered image and observes nothing yet.
bool can_observe(const WorkingModel& model, const Feature& feature) {
    return model.registered(feature.image) && model.point_of(feature) == WorkingModel::kNoPoint;
}

/// The feature itself and its matches in registered images that observe nothing yet, ascending.
std::vector<Feature> free_matches(const WorkingModel& model, const Feature& feature) {
    std::vector<Feature> candidates{feature};
    for (const Feature& match : model.matches().matches(feature)) {
        if (can_observe(model, match)) candidates.push_back(match);
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
                if (!can_observe(model, match)) continue;
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

/// Whether two points have observations in different images only.
bool are_apart(const WorkingModel::Point& a, const WorkingModel::Point& b) {
    auto in_a = a.track.begin();
    for (const Feature& feature : b.track) {  // both ascend
        while (in_a != a.track.end() && in_a->image < feature.image) ++in_a;
        if (in_a != a.track.end() && in_a->image == feature.image) return false;
    }
    return true;
}

/// Position of two joined points by their numbers of observations, when all of these agree with it.
std::optional<Eigen::Vector3d> joint_position(const WorkingModel& model,
                                              const WorkingModel::Point& a,
                                              const WorkingModel::Point& b,
                                              double max_squared_error) {
    if (!are_apart(a, b)) return std::nullopt;
    const auto weight_a = static_cast<double>(a.track.size());
    const auto weight_b = static_cast<double>(b.track.size());
    const Eigen::Vector3d position =
        (weight_a * a.position + weight_b * b.position) / (weight_a + weight_b);
    for (const WorkingModel::Point* point : {&a, &b}) {
        for (const Feature& feature : point->track) {
            if (model.squared_error(feature, position) > max_squared_error) return std::nullopt;
        }
    }
    return position;
}

/// Other points that matches lead to from a point's observations, ascending.
std::vector<std::uint32_t> connected_points(const WorkingModel& model, std::uint32_t point) {
    std::vector<std::uint32_t> connected;
    for (const Feature& feature : model.points()[point].track) {
        for (const Feature& match : model.matches().matches(feature)) {
            const std::uint32_t other = model.point_of(match);
            if (other != WorkingModel::kNoPoint && other != point) connected.push_back(other);
        }
    }
    sort_unique(connected);
    return connected;
}

/// Lets the matches of the points' observations be read by many threads.
void gather_matches(const WorkingModel& model, std::span<const std::uint32_t> points) {
    std::vector<bool> is_seeing(model.image_count(), false);
    for (const std::uint32_t point : points) {
        for (const Feature& feature : model.points()[point].track) is_seeing[feature.image] = true;
    }
    std::vector<std::uint32_t> images;
    for (std::uint32_t image = 0; image < model.image_count(); ++image) {
        if (is_seeing[image]) images.push_back(image);
    }
    model.matches().gather(images);
}

/// Those of the points for which `holds`, which is asked on many threads. Order is kept.
template <typename Predicate>
std::vector<std::uint32_t> points_where(std::span<const std::uint32_t> points,
                                        const Predicate& holds) {
    constexpr std::size_t kPointsATask = 256;  // Guard: of tasks too small to pay
    std::vector<std::uint8_t> found(points.size(), 0);
    in_parallel(points.size(), kPointsATask,
                [&](std::size_t p) { found[p] = holds(points[p]) ? 1 : 0; });
    std::vector<std::uint32_t> result;
    for (std::size_t p = 0; p < points.size(); ++p) {
        if (found[p] != 0) result.push_back(points[p]);
    }
    return result;
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
    sort_unique(points);
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
    const double max_squared_error = options.max_error_px * options.max_error_px;
    // What fits none of a point's own matches now will not, either, when others have been added.
    const auto can_grow = [&](std::uint32_t point) {
        const WorkingModel::Point& p = model.points()[point];
        return std::ranges::any_of(p.track, [&](const Feature& feature) {
            return std::ranges::any_of(model.matches().matches(feature), [&](const Feature& match) {
                return can_observe(model, match) &&
                       model.squared_error(match, p.position) <= max_squared_error;
            });
        });
    };
    const std::vector<std::uint32_t> points = points_seen_by(model, images);
    gather_matches(model, points);
    std::size_t added = 0;
    for (const std::uint32_t point : points_where(points, can_grow))
        added += complete_track(model, point, options);
    return added;
}

std::size_t merge_tracks(WorkingModel& model, std::span<const std::uint32_t> images,
                         const TrackOptions& options) {
    const double max_squared_error = options.max_error_px * options.max_error_px;
    const std::vector<std::uint32_t> points = points_seen_by(model, images);
    std::vector<bool> is_seen(model.points().size(), false);
    for (const std::uint32_t point : points) is_seen[point] = true;
    // A point is joined with those that have not had their turn.
    const auto is_later = [&](std::uint32_t other, std::uint32_t point) {
        return other > point || !is_seen[other];
    };
    const auto joint = [&](std::uint32_t point, std::uint32_t other) {
        return joint_position(model, model.points()[point], model.points()[other],
                              max_squared_error);
    };
    // Before its turn a point is only ever taken by an earlier one: what can join no other now
    // cannot, either, when its turn comes.
    const auto can_join = [&](std::uint32_t point) {
        return std::ranges::any_of(connected_points(model, point), [&](std::uint32_t other) {
            return is_later(other, point) && joint(point, other).has_value();
        });
    };
    gather_matches(model, points);
    std::size_t merged = 0;
    for (const std::uint32_t point : points_where(points, can_join)) {
        if (!model.points()[point].alive()) continue;
        for (const std::uint32_t other : connected_points(model, point)) {
            if (!is_later(other, point)) continue;
            const auto position = joint(point, other);
            if (!position) continue;
            const std::vector<Feature> moved = model.points()[other].track;
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
    std::vector<bool> is_looked_at(model.image_count(), images.empty());
    for (const std::uint32_t image : images) is_looked_at[image] = true;
    const auto changed = [&](std::uint32_t point) { return !model.points()[point].error_px; };
    const auto is_bad = [&](std::uint32_t point, const Feature& feature) {
        return (changed(point) || is_looked_at[feature.image]) &&
               model.squared_error(feature, model.points()[point].position) > max_squared_error;
    };
    const auto is_apart = [&](std::uint32_t point) {
        const WorkingModel::Point& p = model.points()[point];
        return is_seen_from_apart(model, p.track, p.position, min_angle);
    };
    const auto needs_filtering = [&](std::uint32_t point) {
        const auto bad = [&](const Feature& feature) { return is_bad(point, feature); };
        if (std::ranges::any_of(model.points()[point].track, bad)) return true;
        return (changed(point) || images.empty()) && !is_apart(point);
    };
    std::size_t removed = 0;
    std::vector<Feature> bad;
    for (const std::uint32_t point : points_where(points_seen_by(model, images), needs_filtering)) {
        const std::vector<Feature>& track = model.points()[point].track;
        const std::size_t observations = track.size();
        bad.clear();
        std::ranges::copy_if(track, std::back_inserter(bad),
                             [&](const Feature& feature) { return is_bad(point, feature); });
        if (observations - bad.size() < 2) {
            model.remove_point(point);
            removed += observations;
            continue;
        }
        for (const Feature& feature : bad) model.remove_observation(feature);
        removed += bad.size();
        if (!is_apart(point)) {
            removed += model.points()[point].track.size();
            model.remove_point(point);
        }
    }
    return removed;
}

}  // namespace psfm
