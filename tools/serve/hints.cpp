// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/serve/hints.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "stages/algorithms/math/angles.h"
#include "stages/algorithms/math/median.h"

namespace psfm {
namespace {

struct PlacedCamera {
    const SceneCluster* cluster = nullptr;
    const RegisteredImage* image = nullptr;
    std::size_t observations = 0;
    std::vector<float> angles_deg;  // of some of its points

    Eigen::Vector3d centre() const {
        return cluster->world_from_cluster * image->cam_from_cluster.target_origin_in_source();
    }
};
using Cameras = std::map<ImageId, PlacedCamera>;

void look_at_point(const SceneCluster& cluster, const ScenePoint& point, Cameras& cameras) {
    constexpr std::size_t kAngles = 200;  // Guard: an image: their median is good to a few per cent
    std::vector<std::pair<ImageId, Eigen::Vector3d>> rays;
    for (const Observation& observation : point.track) {
        const RegisteredImage* image = cluster.model->find(observation.image);
        if (image == nullptr) continue;
        ++cameras[observation.image].observations;
        rays.emplace_back(
            observation.image,
            (point.position - image->cam_from_cluster.target_origin_in_source()).normalized());
    }
    for (const auto& [image, ray] : rays) {
        std::vector<float>& angles = cameras[image].angles_deg;
        if (angles.size() >= kAngles) continue;
        double smallest = 1.0;
        for (const auto& [other, second] : rays) smallest = std::min(smallest, ray.dot(second));
        angles.push_back(
            static_cast<float>(std::acos(std::clamp(smallest, -1.0, 1.0)) * kDegreesPerRadian));
    }
}

Cameras cameras_of(const Scene& scene) {
    Cameras cameras;
    for (const auto& cluster : scene.clusters) {
        if (!cluster->model) continue;
        for (const RegisteredImage& image : cluster->model->images)
            cameras[image.image] = {cluster.get(), &image, 0, {}};
        for (const ScenePoint& point : cluster->model->points)
            look_at_point(*cluster, point, cameras);
    }
    return cameras;
}

template <typename T>
T median(std::vector<T> values) {
    return values.empty() ? T{} : upper_median(std::move(values));
}

/// The side of a camera on which nobody stands that it holds together with.
const char* empty_side(ImageId image, const Cameras& cameras, const std::vector<EdgeFact>& edges) {
    const PlacedCamera& camera = cameras.at(image);
    const Eigen::Quaterniond cam_from_world =
        camera.image->cam_from_cluster.rotation *
        camera.cluster->world_from_cluster.rotation.conjugate();
    int left = 0, right = 0;
    for (const EdgeFact& edge : edges) {
        if (edge.state != EdgeState::kHolds) continue;
        if (edge.pair.first != image && edge.pair.second != image) continue;
        const auto other =
            cameras.find(edge.pair.first == image ? edge.pair.second : edge.pair.first);
        if (other == cameras.end() || other->second.image == nullptr) continue;
        const double x = (cam_from_world * (other->second.centre() - camera.centre())).x();
        ++(x < 0.0 ? left : right);
    }
    if (left == right) return "either side";
    return left < right ? "the left" : "the right";
}

}  // namespace

std::string_view hint_name(Hint::Kind kind) {
    switch (kind) {
        case Hint::Kind::kJoinParts:
            return "join_parts";
        case Hint::Kind::kLookAlike:
            return "look_alike";
        case Hint::Kind::kFewPoints:
            return "few_points";
        case Hint::Kind::kLowAngle:
            return "low_angle";
    }
    return "unknown";
}

std::vector<Hint> hints_for(const Scene& scene, const std::vector<EdgeFact>& edges,
                            const std::vector<std::string>& names, const HintOptions& options) {
    const Cameras cameras = cameras_of(scene);
    const auto name = [&](ImageId image) {
        return index_of(image) < names.size() ? names[index_of(image)] : std::string("?");
    };
    std::vector<Hint> hints;
    std::map<std::pair<std::uint32_t, std::uint32_t>, const EdgeFact*> between_parts;
    std::map<std::pair<ClusterId, ClusterId>, const EdgeFact*> alike;
    for (const EdgeFact& edge : edges) {
        const auto a = cameras.find(edge.pair.first);
        const auto b = cameras.find(edge.pair.second);
        if (a == cameras.end() || b == cameras.end() || a->second.image == nullptr ||
            b->second.image == nullptr) {
            continue;
        }
        const auto keep_strongest = [&](auto& best, auto first, auto second) {
            const EdgeFact*& known = best[std::minmax(first, second)];
            if (known == nullptr || known->matches < edge.matches) known = &edge;
        };
        if (edge.state == EdgeState::kApart) {
            keep_strongest(alike, a->second.cluster->id, b->second.cluster->id);
        } else if (edge.state == EdgeState::kOpen) {
            keep_strongest(between_parts, a->second.cluster->effective_cluster,
                           b->second.cluster->effective_cluster);
        }
    }
    for (const auto& [parts, edge] : between_parts) {
        hints.push_back({Hint::Kind::kJoinParts, edge->pair.first,
                         "two more from between " + name(edge->pair.first) + " and " +
                             name(edge->pair.second) + ": they would join two parts"});
    }
    for (const auto& [clusters, edge] : alike) {
        hints.push_back({Hint::Kind::kLookAlike, edge->pair.first,
                         name(edge->pair.first) + " and " + name(edge->pair.second) +
                             " look alike: photographs of what lies between tell them apart"});
    }
    std::vector<std::size_t> counts;
    for (const auto& [image, camera] : cameras) counts.push_back(camera.observations);
    const double few = options.few_points * static_cast<double>(median(counts));
    std::vector<std::pair<std::size_t, ImageId>> thin;
    std::vector<std::pair<float, ImageId>> flat;
    for (const auto& [image, camera] : cameras) {
        if (static_cast<double>(camera.observations) < few)
            thin.emplace_back(camera.observations, image);
        if (const float angle = median(camera.angles_deg);
            !camera.angles_deg.empty() && angle < static_cast<float>(options.low_angle_deg)) {
            flat.emplace_back(angle, image);
        }
    }
    std::ranges::sort(thin);
    std::ranges::sort(flat);
    for (const auto& [observations, image] : thin) {
        hints.push_back({Hint::Kind::kFewPoints, image,
                         "two more from " + std::string(empty_side(image, cameras, edges)) +
                             " of " + name(image) + ": only " + std::to_string(observations) +
                             " points hold it"});
    }
    for (const auto& [angle, image] : flat) {
        hints.push_back({Hint::Kind::kLowAngle, image,
                         "one a few steps to the side of " + name(image) +
                             ": what it shows is seen from nearly one direction"});
    }
    if (hints.size() > options.most) hints.resize(options.most);
    return hints;
}

}  // namespace psfm
