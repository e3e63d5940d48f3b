// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/report/residuals.h"

#include <algorithm>

#include "graph/image_places.h"

namespace psfm {
namespace {

struct Use {
    std::uint32_t feature = 0;
    std::uint32_t point = 0;
    Eigen::Vector3d position;
};

}  // namespace

Result<std::vector<std::vector<Residual>>> residuals_of(const Reconstruction& model,
                                                        const KeypointsProvider& keypoints,
                                                        std::span<const std::uint8_t> wanted) {
    std::vector<std::vector<Use>> uses(model.images.size());
    const ImagePlaces places(model);
    const auto is_wanted = [&](ImageId image) {
        const auto place = places(image);
        return place && (wanted.empty() || wanted[*place] != 0);
    };
    for (std::size_t b = 0; b < model.points.blocks().size(); ++b) {
        const PointBlock& block = *model.points.blocks()[b];
        if (std::ranges::none_of(block.images(), is_wanted)) continue;
        auto number = static_cast<std::uint32_t>(model.points.first_of(b));
        for (const ScenePoint& point : block.points()) {
            for (const Observation& observation : point.track) {
                if (!is_wanted(observation.image)) continue;
                uses[*places(observation.image)].push_back(
                    {observation.feature, number, point.position});
            }
            ++number;
        }
    }
    std::vector<std::vector<Residual>> residuals(model.images.size());
    for (std::size_t i = 0; i < model.images.size(); ++i) {
        if (uses[i].empty()) continue;
        const RegisteredImage& image = model.images[i];
        const Camera& camera = model.cameras.at(image.camera);
        const auto features = keypoints(image.image);
        if (!features.ok()) return features.error();
        residuals[i].reserve(uses[i].size());
        for (const Use& use : uses[i]) {
            if (use.feature >= (*features)->size()) {
                return Error{ErrorCode::kDamaged, "a point uses feature " +
                                                      std::to_string(use.feature) + " of image " +
                                                      std::to_string(index_of(image.image)) +
                                                      ", which it lacks: run `psfm check`"};
            }
            const Eigen::Vector2d observed = (**features)[use.feature].position();
            const auto projected = project(camera, image.cam_from_cluster * use.position);
            if (!projected) continue;
            residuals[i].push_back({use.feature, use.point, observed, observed - *projected});
        }
    }
    return residuals;
}

double mean_length_px(const std::vector<Residual>& residuals) {
    if (residuals.empty()) return 0.0;
    double sum = 0.0;
    for (const Residual& residual : residuals) sum += residual.difference_px.norm();
    return sum / static_cast<double>(residuals.size());
}

}  // namespace psfm
