// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/serve/hints.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "graph/image_places.h"
#include "stages/algorithms/math/angles.h"
#include "stages/algorithms/math/median.h"

namespace psfm {
namespace {

struct PlacedCamera {
    const SceneCluster* cluster = nullptr;
    const RegisteredImage* image = nullptr;

    Eigen::Vector3d centre() const {
        return cluster->world_from_cluster * image->cam_from_cluster.target_origin_in_source();
    }
};
using Cameras = std::map<ImageId, PlacedCamera>;

Cameras cameras_of(const Scene& scene) {
    Cameras cameras;
    for (const auto& cluster : scene.clusters) {
        if (!cluster->model) continue;
        for (const RegisteredImage& image : cluster->model->images)
            cameras[image.image] = {cluster.get(), &image};
    }
    return cameras;
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
        if (other == cameras.end()) continue;
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

std::map<ImageId, HintBook::Support> HintBook::support_in(const Reconstruction& model) {
    constexpr std::size_t kAngles = 200;  // Guard: an image: their median is good to a few per cent
    const ImagePlaces places(model);
    std::vector<Support> support(model.images.size());
    std::vector<std::vector<float>> angles_deg(model.images.size());
    std::vector<Eigen::Vector3d> centres;
    centres.reserve(model.images.size());
    for (const RegisteredImage& image : model.images)
        centres.push_back(image.cam_from_cluster.target_origin_in_source());
    std::vector<std::pair<std::uint32_t, Eigen::Vector3d>> rays;
    for (const ScenePoint& point : model.points) {
        rays.clear();
        bool is_asked = false;
        for (const Observation& seen : point.track) {
            const auto place = places(seen.image);
            if (!place) continue;
            ++support[*place].observations;
            is_asked = is_asked || angles_deg[*place].size() < kAngles;
            rays.emplace_back(*place, point.position - centres[*place]);
        }
        if (!is_asked) continue;
        for (auto& [place, ray] : rays) ray.normalize();
        for (const auto& [place, ray] : rays) {
            if (angles_deg[place].size() >= kAngles) continue;
            double smallest = 1.0;
            for (const auto& [other, second] : rays) smallest = std::min(smallest, ray.dot(second));
            angles_deg[place].push_back(
                static_cast<float>(std::acos(std::clamp(smallest, -1.0, 1.0)) * kDegreesPerRadian));
        }
    }
    std::map<ImageId, Support> by_image;
    for (std::size_t i = 0; i < support.size(); ++i) {
        if (!angles_deg[i].empty()) support[i].angle_deg = upper_median(std::move(angles_deg[i]));
        by_image.emplace(model.images[i].image, support[i]);
    }
    return by_image;
}

void HintBook::follow(const Scene& scene, const WholeModel& whole) {
    std::set<ClusterId> alive;
    for (const auto& cluster : scene.clusters) {
        if (!cluster->model) continue;
        alive.insert(cluster->id);
        Known& known = known_[cluster->id];
        const bool rests = cluster->model->points.empty();
        if (known.model &&
            (rests ? known.revision == cluster->revision : known.model == cluster->model)) {
            known.model = cluster->model;  // without its points, where it rests
            continue;
        }
        const auto model = rests && whole ? whole(*cluster) : cluster->model;
        known = {cluster->model, cluster->revision, {}};
        if (model && !model->points.empty()) known.support = support_in(*model);
    }
    std::erase_if(known_, [&](const auto& known) { return !alive.contains(known.first); });
}

std::vector<Hint> HintBook::hints(const Scene& scene, const std::vector<EdgeFact>& edges,
                                  const std::vector<std::string>& names, const WholeModel& whole) {
    follow(scene, whole);
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
        if (a == cameras.end() || b == cameras.end()) continue;
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
    hints.reserve(between_parts.size());
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
    for (const auto& [cluster, known] : known_) {
        for (const auto& [image, support] : known.support) counts.push_back(support.observations);
    }
    const double few =
        counts.empty() ? 0.0 : options_.few_points * static_cast<double>(upper_median(counts));
    std::vector<std::pair<std::size_t, ImageId>> thin;
    std::vector<std::pair<float, ImageId>> flat;
    for (const auto& [cluster, known] : known_) {
        for (const auto& [image, support] : known.support) {
            if (!cameras.contains(image)) continue;  // in the stored model alone
            if (static_cast<double>(support.observations) < few)
                thin.emplace_back(support.observations, image);
            if (support.observations > 0 &&
                support.angle_deg < static_cast<float>(options_.low_angle_deg)) {
                flat.emplace_back(support.angle_deg, image);
            }
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
    if (hints.size() > options_.most) hints.resize(options_.most);
    return hints;
}

}  // namespace psfm
