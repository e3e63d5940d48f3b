// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <numeric>

#include "tests/synthetic/rng.h"
#include "tests/synthetic/scene.h"

namespace psfm::synthetic {

Reconstruction true_reconstruction(const SyntheticScene& scene, const Sim3& cluster_from_world,
                                   std::span<const ImageId> images) {
    Reconstruction result;
    for (const ImageId id : images) {
        const SceneImage& image = scene.images.at(index_of(id));
        result.images.push_back(
            {id, image.camera, transform_pose(image.cam_from_world, cluster_from_world)});
        result.cameras.emplace(image.camera, scene.cameras.at(image.camera));
    }
    std::vector<ScenePoint> points;
    const std::vector<std::vector<Observation>> all_tracks = tracks(scene);
    for (std::size_t i = 0; i < all_tracks.size(); ++i) {
        ScenePoint point;
        std::ranges::copy_if(all_tracks[i], std::back_inserter(point.track),
                             [&](const Observation& seen) {
                                 return std::ranges::binary_search(images, seen.image);
                             });
        if (point.track.size() < 2) continue;
        point.position = cluster_from_world * scene.points[i].position;
        points.push_back(std::move(point));
    }
    result.points = std::move(points);
    return result;
}

Reconstruction true_reconstruction(const SyntheticScene& scene, const Sim3& cluster_from_world) {
    std::vector<ImageId> all;
    for (std::uint32_t i = 0; i < scene.images.size(); ++i) all.push_back(static_cast<ImageId>(i));
    return true_reconstruction(scene, cluster_from_world, all);
}

Sim3 random_gauge(std::uint64_t seed) {
    Rng rng(mix_seed(seed, 5));
    Sim3 gauge;
    gauge.rotation = rng.rotation();
    gauge.scale = 0.2 * std::pow(25.0, rng.uniform());
    gauge.translation = 5.0 * rng.normal3();
    return gauge;
}

}  // namespace psfm::synthetic
