// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/model/surroundings.h"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <set>
#include <utility>

#include "stages/reconstruction/model/local_numbers.h"

namespace psfm {
namespace {

/// What an image is to the part.
enum class Role : std::uint8_t { kOutside, kObserver, kNeighbor, kNew };

/// New members and their neighbours, by local number.
std::vector<Role> new_images_and_neighbors(const ClusterProblem& problem,
                                           const LocalNumbers& numbers) {
    std::vector<Role> roles(problem.images.size(), Role::kNew);
    for (const RegisteredImage& image : problem.recycled.front()->images)
        roles[numbers.of(image.image)] = Role::kOutside;
    for (std::size_t i = 0; i < roles.size(); ++i) {
        if (roles[i] != Role::kNew) continue;
        for (const ViewGraph::Edge& edge : problem.view_graph.edges(problem.images[i].id)) {
            const auto neighbor = numbers.find(edge.neighbor);
            if (neighbor && roles[*neighbor] == Role::kOutside) roles[*neighbor] = Role::kNeighbor;
        }
    }
    return roles;
}

/// The view graph's edges among new images and neighbours.
ViewGraph edges_inside(const ClusterProblem& problem, const LocalNumbers& numbers,
                       const std::vector<Role>& roles) {
    std::vector<VerifiedPairPtr> pairs;
    std::vector<VerifiedPairPtr> weak;
    for (std::size_t i = 0; i < roles.size(); ++i) {
        if (roles[i] < Role::kNeighbor) continue;
        const ImageId image = problem.images[i].id;
        for (const ViewGraph::Edge& edge : problem.view_graph.edges(image)) {
            const auto neighbor = numbers.find(edge.neighbor);
            if (edge.neighbor > image && neighbor && roles[*neighbor] >= Role::kNeighbor)
                (edge.weight > 0.0 ? pairs : weak).push_back(edge.pair);
        }
    }
    ViewGraph graph(pairs);
    for (const VerifiedPairPtr& pair : weak) {
        while (graph.size() <= index_of(pair->pair.second)) graph.add_node();
        graph.add_edge(pair->pair.first, pair->pair.second, 0.0, pair);
    }
    return graph;
}

/// Blocks of points that an image of this role or a closer one sees some of, ascending.
std::vector<std::size_t> blocks_seen_from(Role least, const ScenePoints& points,
                                          const LocalNumbers& numbers,
                                          const std::vector<Role>& roles) {
    std::vector<std::size_t> seen;
    for (std::size_t b = 0; b < points.blocks().size(); ++b) {
        const bool is_seen = std::ranges::any_of(points.blocks()[b]->images(), [&](ImageId image) {
            return roles[numbers.of(image)] >= least;
        });
        if (is_seen) seen.push_back(b);
    }
    return seen;
}

/// The points that a neighbour sees.
struct InsidePoints {
    std::vector<ScenePoint> points;
    std::vector<std::uint8_t> is_inside;  ///< by point of the model
};

InsidePoints points_of_neighbors(const ScenePoints& all, const LocalNumbers& numbers,
                                 const std::vector<Role>& roles) {
    InsidePoints inside{{}, std::vector<std::uint8_t>(all.size(), 0)};
    for (const std::size_t b : blocks_seen_from(Role::kNeighbor, all, numbers, roles)) {
        std::size_t number = all.first_of(b);
        for (const ScenePoint& point : all.blocks()[b]->points()) {
            const bool is_inside = std::ranges::any_of(point.track, [&](const Observation& seen) {
                return roles[numbers.of(seen.image)] == Role::kNeighbor;
            });
            if (is_inside) inside.points.push_back(point);
            inside.is_inside[number++] = is_inside ? 1 : 0;
        }
    }
    return inside;
}

/// The model's images in the part, with the part's cameras.
Reconstruction part_of(const Reconstruction& model, std::vector<ScenePoint> points,
                       const ClusterProblem& part, const LocalNumbers& numbers,
                       const std::vector<Role>& roles) {
    Reconstruction inside;
    for (const auto& [id, accepted] : part.cameras) {
        if (const auto found = model.cameras.find(id); found != model.cameras.end())
            inside.cameras.insert(*found);
    }
    for (const RegisteredImage& image : model.images) {
        if (roles[numbers.of(image.image)] != Role::kOutside) inside.images.push_back(image);
    }
    inside.points = std::move(points);
    return inside;
}

}  // namespace

std::optional<Surroundings> surroundings_of_new_images(const ClusterProblem& problem,
                                                       double max_points) {
    const Reconstruction& model = *problem.recycled.front();
    if (model.images.size() >= problem.images.size()) return std::nullopt;
    const LocalNumbers numbers(problem);
    std::vector<Role> roles = new_images_and_neighbors(problem, numbers);
    InsidePoints inside = points_of_neighbors(model.points, numbers, roles);
    if (static_cast<double>(inside.points.size()) >
        max_points * static_cast<double>(model.points.size()))
        return std::nullopt;
    for (const ScenePoint& point : inside.points) {
        for (const Observation& seen : point.track) {
            Role& role = roles[numbers.of(seen.image)];
            if (role == Role::kOutside) role = Role::kObserver;
        }
    }

    Surroundings surroundings;
    ClusterProblem& part = surroundings.problem;
    part.cluster = problem.cluster;
    part.topology = problem.topology;
    part.calibrated = problem.calibrated;
    part.twins = problem.twins;
    part.recycled_state = problem.recycled_state;
    part.fix_intrinsics = problem.fix_intrinsics;
    part.concluding = problem.concluding;
    part.seed = problem.seed;
    for (std::size_t i = 0; i < roles.size(); ++i) {
        if (roles[i] == Role::kOutside) continue;
        const ClusterImage& image = problem.images[i];
        part.images.push_back(image);
        part.cameras.emplace(image.camera, problem.cameras.at(image.camera));
    }
    std::set<CameraId> lenses_outside;
    for (std::size_t i = 0; i < roles.size(); ++i) {
        if (roles[i] == Role::kOutside)
            lenses_outside.insert(lens_of(problem, problem.images[i].camera));
    }
    for (const auto& [id, camera] : part.cameras) {
        if (lenses_outside.contains(lens_of(problem, id))) part.held_cameras.insert(id);
    }
    part.view_graph = edges_inside(problem, numbers, roles);
    part.recycled = problem.recycled;
    part.recycled.front() = std::make_shared<const Reconstruction>(
        part_of(model, std::move(inside.points), part, numbers, roles));
    surroundings.is_inside = std::move(inside.is_inside);
    return surroundings;
}

Reconstruction put_back(const Reconstruction& whole, const Surroundings& surroundings,
                        const Reconstruction& part) {
    Reconstruction result;
    result.cameras = whole.cameras;
    for (const auto& [id, camera] : part.cameras) result.cameras[id] = camera;
    // Both ascend; where both have an image, the part's pose is the newer one.
    std::ranges::set_union(part.images, whole.images, std::back_inserter(result.images), {},
                           &RegisteredImage::image, &RegisteredImage::image);
    result.points = whole.points.without(surroundings.is_inside);
    result.points.append(part.points);
    return result;
}

}  // namespace psfm
