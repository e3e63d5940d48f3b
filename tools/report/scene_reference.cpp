// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/report/scene_reference.h"

#include <algorithm>
#include <map>
#include <vector>

namespace psfm {

std::optional<WorldReference> world_reference_of(const Scene& scene,
                                                 std::span<const Image> images) {
    std::map<std::uint32_t, std::vector<CameraCentre>> by_part;
    for (const auto& cluster : scene.clusters) {
        if (!cluster->model) continue;
        for (const RegisteredImage& image : cluster->model->images) {
            by_part[cluster->effective_cluster].push_back(
                {image.image,
                 cluster->world_from_cluster * image.cam_from_cluster.target_origin_in_source()});
        }
    }
    std::vector<std::vector<CameraCentre>> cameras;
    cameras.reserve(by_part.size());
    for (auto& [number, centres] : by_part) cameras.push_back(std::move(centres));
    return world_reference(cameras, evidence_of(images));
}

bool stands_on_the_earth(const std::optional<WorldReference>& reference) {
    return reference && !reference->models.empty() &&
           std::ranges::all_of(reference->models, [](const PositionAgreement& model) {
               return model.is_enough(GeoreferenceOptions{});
           });
}

}  // namespace psfm
