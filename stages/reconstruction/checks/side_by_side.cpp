// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/checks/side_by_side.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "stages/algorithms/math/angles.h"
#include "stages/algorithms/math/in_parallel.h"
#include "stages/algorithms/math/kd_tree.h"
#include "stages/algorithms/math/median.h"
#include "stages/reconstruction/checks/companions.h"

namespace psfm {
namespace {

/// An image, and what it has seen that others are expected to see.
struct SideView {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    Eigen::Vector3d ahead = Eigen::Vector3d::UnitZ();  ///< unit, in the cluster
    const Camera* camera = nullptr;
    std::vector<const ScenePoint*> points;
    double median_depth = 0.0;  ///< 0: it has seen nothing
};

double median_depth(const SideView& view) {
    std::vector<double> depths;
    depths.reserve(view.points.size());
    for (const ScenePoint* point : view.points)
        depths.push_back((point->position - view.centre).dot(view.ahead));
    if (depths.empty()) return 0.0;
    return std::max(0.0, upper_median(std::move(depths)));
}

/// Of an image that has seen nothing yet.
SideView side_view_of(const Reconstruction& model, const RegisteredImage& image) {
    SideView view;
    view.centre = image.cam_from_cluster.target_origin_in_source();
    view.ahead = image.cam_from_cluster.rotation.conjugate() * Eigen::Vector3d::UnitZ();
    view.camera = &model.cameras.at(image.camera);
    return view;
}

/// Every so many-th point is enough for about so many of each image.
std::uint32_t step_for(const Reconstruction& model, std::uint32_t points_per_image) {
    if (points_per_image == 0 || model.images.empty()) return 1;
    std::size_t observations = 0;
    for (const ScenePoint& point : model.points) observations += point.track.size();
    const std::size_t step = observations / (points_per_image * model.images.size());
    return static_cast<std::uint32_t>(std::max<std::size_t>(1, step));
}

/// Of every `step`-th point.
std::vector<SideView> side_views_of(const Reconstruction& model, std::uint32_t step,
                                    const PlaceOptions& options) {
    std::vector<SideView> views;
    views.reserve(model.images.size());
    for (const RegisteredImage& image : model.images) views.push_back(side_view_of(model, image));
    const std::vector<std::uint32_t> positions = positions_by_id(model);
    for (std::uint32_t p = step / 2; p < model.points.size(); p += step) {
        const ScenePoint& point = model.points[p];
        if (point.track.size() < options.min_track) continue;
        for (const Observation& observation : point.track)
            views[positions[index_of(observation.image)]].points.push_back(&point);
    }
    in_parallel(views.size(), 64,
                [&](std::size_t i) { views[i].median_depth = median_depth(views[i]); });
    return views;
}

/// Images that stand where one does, and how far from it.
using Nearby = std::vector<std::pair<double, std::uint32_t>>;

/// The nearest of those that look where one looks, too.
std::vector<std::uint32_t> nearest_of(Nearby near, const PlaceOptions& options) {
    std::ranges::sort(near);
    if (near.size() > options.max_neighbors) near.resize(options.max_neighbors);
    std::vector<std::uint32_t> nearest;
    nearest.reserve(near.size());
    for (const auto& [distance, other] : near) nearest.push_back(other);
    return nearest;
}

double min_cosine(const PlaceOptions& options) {
    return std::cos(radians_from_degrees(options.max_turn_deg));
}

/// Images side by side with one: the nearest of them.
std::vector<std::uint32_t> neighbors_of(std::uint32_t own, const std::vector<SideView>& views,
                                        const KdTree& centres, const PlaceOptions& options) {
    const SideView& view = views[own];
    Nearby near;
    for (const std::uint32_t other :
         centres.nearer_than(view.centre, options.max_offset * view.median_depth)) {
        const double distance = (views[other].centre - view.centre).norm();
        if (other != own && distance < options.max_offset * views[other].median_depth &&
            view.ahead.dot(views[other].ahead) >= min_cosine(options))
            near.emplace_back(distance, other);
    }
    return nearest_of(std::move(near), options);
}

/// The same by the depths that the one sees alone; for few images, since all others are looked at.
std::vector<std::uint32_t> neighbors_by_own_depth(std::uint32_t own, const SideView& view,
                                                  const Reconstruction& model,
                                                  const std::vector<Eigen::Vector3d>& centres,
                                                  const PlaceOptions& options) {
    const double reach = options.max_offset * view.median_depth;
    Nearby near;
    for (std::uint32_t other = 0; other < centres.size(); ++other) {
        const double squared_distance = (centres[other] - view.centre).squaredNorm();
        if (other == own || squared_distance >= reach * reach) continue;
        if (view.ahead.dot(side_view_of(model, model.images[other]).ahead) >= min_cosine(options))
            near.emplace_back(std::sqrt(squared_distance), other);
    }
    return nearest_of(std::move(near), options);
}

/// Adds what an image should see of what another one has seen, each point `weight` times.
void count(std::span<const ScenePoint* const> seen, const Camera& camera,
           const RegisteredImage& image, std::uint32_t weight, double rim, SideBySide& pair) {
    const Eigen::Array2d size(camera.width, camera.height);
    const double margin = rim * size.maxCoeff();
    for (const ScenePoint* point : seen) {
        const auto pixel = project(camera, image.cam_from_cluster * point->position);
        if (!pixel || (pixel->array() < margin).any() || (pixel->array() > size - margin).any())
            continue;
        pair.expected += weight;
        if (point->is_seen_by(image.image)) pair.shared += weight;
    }
}

void count_all(const Reconstruction& model, const std::vector<SideView>& views,
               std::uint32_t weight, double margin, std::vector<SideBySide>& pairs) {
    in_parallel(pairs.size(), 16, [&](std::size_t k) {
        SideBySide& pair = pairs[k];
        const std::uint32_t first = pair.first;
        const std::uint32_t second = pair.second;
        count(views[first].points, *views[second].camera, model.images[second], weight, margin,
              pair);
        count(views[second].points, *views[first].camera, model.images[first], weight, margin,
              pair);
    });
}

}  // namespace

std::vector<SideBySide> find_side_by_side(const Reconstruction& model, const PlaceOptions& options,
                                          std::uint32_t points_per_image) {
    const std::uint32_t step = step_for(model, points_per_image);
    const std::vector<SideView> views = side_views_of(model, step, options);
    std::vector<Eigen::Vector3d> centres;
    centres.reserve(views.size());
    for (const SideView& view : views) centres.push_back(view.centre);
    const KdTree tree(std::move(centres));

    std::vector<std::vector<std::uint32_t>> neighbors(views.size());
    in_parallel(views.size(), [&](std::size_t i) {
        neighbors[i] = neighbors_of(static_cast<std::uint32_t>(i), views, tree, options);
    });
    std::vector<SideBySide> pairs;
    for (std::uint32_t i = 0; i < neighbors.size(); ++i) {
        for (const std::uint32_t other : neighbors[i])
            pairs.push_back({std::min(i, other), std::max(i, other), 0, 0});
    }
    const auto ends = [](const SideBySide& pair) { return std::pair(pair.first, pair.second); };
    std::ranges::sort(pairs, {}, ends);
    const auto repeated = std::ranges::unique(pairs, {}, ends);
    pairs.erase(repeated.begin(), repeated.end());

    count_all(model, views, step, options.margin, pairs);
    std::erase_if(pairs,
                  [&](const SideBySide& pair) { return pair.expected < options.min_expected; });
    return pairs;
}

std::vector<SideBySide> count_all_points(const Reconstruction& model, const PlaceOptions& options,
                                         std::span<const SideBySide> pairs) {
    std::vector<SideBySide> counted;
    counted.reserve(pairs.size());
    for (const SideBySide& pair : pairs) counted.push_back({pair.first, pair.second, 0, 0});
    count_all(model, side_views_of(model, 1, options), 1, options.margin, counted);
    std::erase_if(counted,
                  [&](const SideBySide& pair) { return pair.expected < options.min_expected; });
    return counted;
}

bool stand_beside_strangers(const Reconstruction& model, const ScenePoints& seen,
                            std::span<const ImageId> images, double max_shared_part,
                            const PlaceOptions& options) {
    std::map<ImageId, SideView> asked;
    for (const ImageId image : images)
        asked.emplace(image, side_view_of(model, *model.find(image)));
    for (const ScenePoint& point : seen) {
        if (point.track.size() < options.min_track) continue;
        for (const Observation& observation : point.track) {
            if (const auto view = asked.find(observation.image); view != asked.end())
                view->second.points.push_back(&point);
        }
    }
    std::vector<Eigen::Vector3d> centres;
    centres.reserve(model.images.size());
    for (const RegisteredImage& image : model.images)
        centres.push_back(image.cam_from_cluster.target_origin_in_source());
    return std::ranges::any_of(asked, [&](auto& entry) {
        auto& [image, view] = entry;
        view.median_depth = median_depth(view);
        const auto own = static_cast<std::uint32_t>(model.find(image) - model.images.data());
        const auto neighbors = neighbors_by_own_depth(own, view, model, centres, options);
        return std::ranges::any_of(neighbors, [&](std::uint32_t other) {
            const RegisteredImage& neighbor = model.images[other];
            SideBySide pair;
            count(view.points, model.cameras.at(neighbor.camera), neighbor, 1, options.margin,
                  pair);
            // Both ways together more are asked for.
            return 2 * pair.expected >= options.min_expected &&
                   pair.shared_part() <= max_shared_part;
        });
    });
}

}  // namespace psfm
