// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/merge/geo/world_reference.h"

#include <algorithm>

namespace psfm {

std::optional<WorldReference> world_reference(std::span<const std::vector<CameraCentre>> models,
                                              std::span<const ImageEvidence> evidence,
                                              const GeoreferenceOptions& options) {
    std::vector<std::vector<ImageId>> parts(models.size());
    for (std::size_t m = 0; m < models.size(); ++m) {
        for (const CameraCentre& camera : models[m]) parts[m].push_back(camera.image);
    }
    const std::optional<GpsPosition> datum = datum_of(evidence, parts);
    if (!datum) return std::nullopt;
    WorldReference reference{*datum, {}};
    for (const std::vector<CameraCentre>& model : models) {
        std::vector<LocatedCamera> cameras;
        for (const CameraCentre& camera : model) {
            const ImageEvidence* found = find_evidence(evidence, camera.image);
            if (found == nullptr) continue;
            if (const auto located = locate(camera.in_world, *found, *datum))
                cameras.push_back(*located);
        }
        reference.models.push_back(agreement(cameras, Sim3{}, options));
    }
    const bool any = std::ranges::any_of(
        reference.models, [&](const auto& model) { return model.is_enough(options); });
    return any ? std::optional(reference) : std::nullopt;
}

}  // namespace psfm
