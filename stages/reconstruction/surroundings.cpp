// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/surroundings.h"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <numeric>
#include <utility>

#include "stages/reconstruction/in_parallel.h"
#include "stages/reconstruction/local_numbers.h"

namespace psfm {
namespace {

constexpr std::size_t kPointsATask = 4096;
/// A part with more of the points than this saves nothing. Ours.
constexpr double kMostPoints = 0.75;

/// What an image is to the part.
enum class Role : std::uint8_t { kOutside, kObserver, kNeighbor, kNew };

/// New members and their neighbours, by local number.
std::vector<Role> new_images_and_neighbors(const ClusterProblem& problem,
                                           const LocalNumbers& numbers) {
    std::vector<Role> roles(problem.images.size(), Role::kNew);
    for (const RegisteredImage& image : problem.recycled.front()->images)
        roles[numbers.of(image.image)] = Role::kOutside;
    for (const VerifiedPairPtr& pair : problem.pairs) {
        Role& first = roles[numbers.of(pair->pair.first)];
        Role& second = roles[numbers.of(pair->pair.second)];
        if (first == Role::kNew && second == Role::kOutside) second = Role::kNeighbor;
        if (second == Role::kNew && first == Role::kOutside) first = Role::kNeighbor;
    }
    return roles;
}

/// Points that a neighbour sees, by position in the model.
std::vector<std::uint8_t> points_of_neighbors(const Reconstruction& model,
                                              const LocalNumbers& numbers,
                                              const std::vector<Role>& roles) {
    std::vector<std::uint8_t> is_inside(model.points.size(), 0);
    in_parallel(model.points.size(), kPointsATask, [&](std::size_t p) {
        is_inside[p] = std::ranges::any_of(model.points[p].track, [&](const Observation& seen) {
            return roles[numbers.of(seen.image)] == Role::kNeighbor;
        });
    });
    return is_inside;
}

/// The model's images in the part, with all cameras: a new image may share one with others.
Reconstruction part_of(const Reconstruction& model, const std::vector<std::uint8_t>& is_inside,
                       const LocalNumbers& numbers, const std::vector<Role>& roles) {
    Reconstruction part;
    part.cameras = model.cameras;
    for (const RegisteredImage& image : model.images) {
        if (roles[numbers.of(image.image)] != Role::kOutside) part.images.push_back(image);
    }
    for (std::size_t p = 0; p < model.points.size(); ++p) {
        if (is_inside[p] != 0) part.points.push_back(model.points[p]);
    }
    return part;
}

}  // namespace

std::optional<Surroundings> surroundings_of_new_images(const ClusterProblem& problem) {
    const Reconstruction& model = *problem.recycled.front();
    if (model.images.size() >= problem.images.size()) return std::nullopt;
    const LocalNumbers numbers(problem);
    std::vector<Role> roles = new_images_and_neighbors(problem, numbers);
    Surroundings surroundings;
    surroundings.is_inside = points_of_neighbors(model, numbers, roles);
    const std::vector<std::uint8_t>& is_inside = surroundings.is_inside;
    const auto inside = std::accumulate(is_inside.begin(), is_inside.end(), std::size_t{0});
    if (static_cast<double>(inside) > kMostPoints * static_cast<double>(model.points.size()))
        return std::nullopt;
    for (std::size_t p = 0; p < model.points.size(); ++p) {
        if (is_inside[p] == 0) continue;
        for (const Observation& seen : model.points[p].track) {
            Role& role = roles[numbers.of(seen.image)];
            if (role == Role::kOutside) role = Role::kObserver;
        }
    }

    ClusterProblem& part = surroundings.problem;
    part.cluster = problem.cluster;
    part.topology = problem.topology;
    part.calibrated = problem.calibrated;
    part.recycled_state = problem.recycled_state;
    part.fix_intrinsics = problem.fix_intrinsics;
    part.seed = problem.seed;
    for (std::size_t i = 0; i < roles.size(); ++i) {
        const ClusterImage& image = problem.images[i];
        if (roles[i] == Role::kOutside) {
            part.held_cameras.insert(image.camera);
        } else {
            part.images.push_back(image);
            part.cameras.emplace(image.camera, problem.cameras.at(image.camera));
        }
    }
    for (const VerifiedPairPtr& pair : problem.pairs) {
        if (roles[numbers.of(pair->pair.first)] >= Role::kNeighbor &&
            roles[numbers.of(pair->pair.second)] >= Role::kNeighbor)
            part.pairs.push_back(pair);
    }
    part.recycled = problem.recycled;
    part.recycled.front() =
        std::make_shared<const Reconstruction>(part_of(model, is_inside, numbers, roles));
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
    std::vector<const ScenePoint*> points;
    for (std::size_t p = 0; p < whole.points.size(); ++p) {
        if (surroundings.is_inside[p] == 0) points.push_back(&whole.points[p]);
    }
    for (const ScenePoint& point : part.points) points.push_back(&point);
    result.points.resize(points.size());
    in_parallel(points.size(), kPointsATask, [&](std::size_t p) { result.points[p] = *points[p]; });
    return result;
}

}  // namespace psfm
