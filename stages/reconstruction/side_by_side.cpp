// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/side_by_side.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "stages/merge/kd_tree.h"
#include "stages/reconstruction/in_parallel.h"

namespace psfm {
namespace {

/// An image, and what it has seen that others are expected to see.
struct View {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    Eigen::Vector3d ahead = Eigen::Vector3d::UnitZ();  ///< unit, in the cluster
    const Camera* camera = nullptr;
    std::vector<std::uint32_t> points;  ///< ascending
    double median_depth = 0.0;          ///< 0: it has seen nothing
};

double median_depth(const Reconstruction& model, const View& view) {
    std::vector<double> depths;
    depths.reserve(view.points.size());
    for (const std::uint32_t point : view.points)
        depths.push_back((model.points[point].position - view.centre).dot(view.ahead));
    if (depths.empty()) return 0.0;
    const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
    std::ranges::nth_element(depths, middle);
    return std::max(0.0, *middle);
}

std::vector<View> views_of(const Reconstruction& model, const PlaceOptions& options) {
    std::vector<View> views(model.images.size());
    for (std::size_t i = 0; i < views.size(); ++i) {
        const RegisteredImage& image = model.images[i];
        views[i].centre = image.cam_from_cluster.target_origin_in_source();
        views[i].ahead = image.cam_from_cluster.rotation.conjugate() * Eigen::Vector3d::UnitZ();
        views[i].camera = &model.cameras.at(image.camera);
    }
    for (std::uint32_t p = 0; p < model.points.size(); ++p) {
        const std::vector<Observation>& track = model.points[p].track;
        if (track.size() < options.min_track) continue;
        // Both ascend by image.
        auto image = model.images.begin();
        for (const Observation& observation : track) {
            image = std::lower_bound(image, model.images.end(), observation.image,
                                     [](const RegisteredImage& registered, ImageId id) {
                                         return registered.image < id;
                                     });
            views[static_cast<std::size_t>(image - model.images.begin())].points.push_back(p);
        }
    }
    in_parallel(views.size(), 64,
                [&](std::size_t i) { views[i].median_depth = median_depth(model, views[i]); });
    return views;
}

/// Images side by side with one, of those after it; the nearest of all of them.
std::vector<std::uint32_t> neighbors_of(std::uint32_t own, const std::vector<View>& views,
                                        const KdTree& centres, const PlaceOptions& options) {
    const double min_cosine = std::cos(options.max_turn_deg * std::numbers::pi / 180.0);
    const View& view = views[own];
    std::vector<std::pair<double, std::uint32_t>> near;
    for (const std::uint32_t other :
         centres.nearer_than(view.centre, options.max_offset * view.median_depth)) {
        const double distance = (views[other].centre - view.centre).norm();
        if (other == own || distance >= options.max_offset * views[other].median_depth ||
            view.ahead.dot(views[other].ahead) < min_cosine)
            continue;
        near.emplace_back(distance, other);
    }
    std::ranges::sort(near);
    if (near.size() > options.max_neighbors) near.resize(options.max_neighbors);
    std::vector<std::uint32_t> neighbors;
    neighbors.reserve(near.size());
    for (const auto& [distance, other] : near) neighbors.push_back(other);
    return neighbors;
}

bool sees(const ScenePoint& point, ImageId image) {
    const auto found = std::ranges::lower_bound(point.track, image, {}, &Observation::image);
    return found != point.track.end() && found->image == image;
}

/// Adds what `to` should see of what `from` has seen.
void count(const Reconstruction& model, const View& from, const View& to,
           const RegisteredImage& image, SideBySide& pair) {
    /// Features are not found at the very edge, and poses are not exact.
    constexpr double kMargin = 0.02;
    const Eigen::Array2d size(to.camera->width, to.camera->height);
    const double margin = kMargin * size.maxCoeff();
    for (const std::uint32_t p : from.points) {
        const ScenePoint& point = model.points[p];
        const auto pixel = project(*to.camera, image.cam_from_cluster * point.position);
        if (!pixel || (pixel->array() < margin).any() || (pixel->array() > size - margin).any())
            continue;
        ++pair.expected;
        if (sees(point, image.image)) ++pair.shared;
    }
}

}  // namespace

std::vector<SideBySide> find_side_by_side(const Reconstruction& model,
                                          const PlaceOptions& options) {
    const std::vector<View> views = views_of(model, options);
    std::vector<Eigen::Vector3d> centres;
    centres.reserve(views.size());
    for (const View& view : views) centres.push_back(view.centre);
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

    in_parallel(pairs.size(), 16, [&](std::size_t k) {
        SideBySide& pair = pairs[k];
        count(model, views[pair.first], views[pair.second], model.images[pair.second], pair);
        count(model, views[pair.second], views[pair.first], model.images[pair.first], pair);
    });
    std::erase_if(pairs,
                  [&](const SideBySide& pair) { return pair.expected < options.min_expected; });
    return pairs;
}

}  // namespace psfm
