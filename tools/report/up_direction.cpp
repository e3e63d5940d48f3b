// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/report/up_direction.h"

#include "stages/merge/geo/gravity.h"

namespace psfm {

Eigen::Vector3d up_direction(const std::vector<const SceneCluster*>& clusters,
                             const std::vector<Image>& images) {
    Eigen::Vector3d up = Eigen::Vector3d::Zero();
    for (const SceneCluster* cluster : clusters) {
        for (const RegisteredImage& image : cluster->model->images) {
            if (index_of(image.image) >= images.size()) continue;
            const std::uint8_t orientation = images[index_of(image.image)].metadata.orientation;
            up += cluster->world_from_cluster.rotation *
                  (image.cam_from_cluster.rotation.conjugate() * up_in_camera(orientation));
        }
    }
    constexpr double kNothing = 1e-9;  // Guard: what cannot be normalised
    return up.norm() < kNothing ? Eigen::Vector3d::UnitZ() : up.normalized();
}

std::vector<const SceneCluster*> clusters_with_models(const Scene& scene) {
    std::vector<const SceneCluster*> clusters;
    for (const auto& cluster : scene.clusters) {
        if (cluster->model && !cluster->model->empty()) clusters.push_back(cluster.get());
    }
    return clusters;
}

}  // namespace psfm
