// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/scheduler/session_parts.h"

namespace psfm::test {

Result<std::map<std::uint32_t, std::vector<NamedPose>>> parts_of(const SessionReader& session) {
    const auto images = session.images();
    if (!images.ok()) return images.error();
    const auto scene = session.scene();
    if (!scene.ok()) return scene.error();
    std::map<std::uint32_t, std::vector<NamedPose>> parts;
    for (const auto& cluster : scene->clusters) {
        if (!cluster->model) continue;
        for (const RegisteredImage& image : cluster->model->images) {
            parts[cluster->effective_cluster].push_back(
                {(*images)[index_of(image.image)].name,
                 transform_pose(image.cam_from_cluster, cluster->world_from_cluster)});
        }
    }
    return parts;
}

}  // namespace psfm::test
