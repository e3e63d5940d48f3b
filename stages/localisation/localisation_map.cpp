// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/localisation/localisation_map.h"

#include <algorithm>
#include <cmath>

#include "stages/algorithms/matching/nearest_descriptors.h"

namespace psfm {

LocalisationMap::LocalisationMap(const Scene& scene) {
    for (const auto& cluster : scene.clusters) {
        if (!cluster->model) continue;
        for (const RegisteredImage& image : cluster->model->images) {
            places_.try_emplace(
                image.image,
                Place{transform_pose(image.cam_from_cluster, cluster->world_from_cluster),
                      cluster->model->cameras.at(image.camera), cluster->effective_cluster});
        }
        for (const ScenePoint& point : cluster->model->points) {
            const auto number = static_cast<std::uint32_t>(points_.size());
            points_.push_back(
                {cluster->world_from_cluster * point.position, cluster->effective_cluster});
            std::vector<ImageId>& images = images_of_.emplace_back();
            for (const Observation& seen : point.track) {
                observations_[seen.image].emplace_back(seen.feature, number);
                images.push_back(seen.image);
            }
        }
    }
    for (auto& [image, observations] : observations_) std::ranges::sort(observations);
}

void LocalisationMap::add(ImageId image, const Descriptors& descriptors,
                          const LocalisationMapOptions& options) {
    const auto found = observations_.find(image);
    if (found == observations_.end()) return;
    const Observations& observations = found->second;
    const std::size_t count = std::min(options.features_per_image, observations.size());
    for (std::size_t k = 0; k < count; ++k) {
        const auto& [feature, point] = observations[k * observations.size() / count];
        if (feature >= descriptors.rows()) continue;
        const std::uint8_t* row = descriptors.row(feature);
        sample_.values.insert(sample_.values.end(), row, row + Descriptors::kSize);
        sampled_points_.push_back(point);
    }
}

void LocalisationMap::finish() {
    packed_ = pack(sample_);
    sample_ = {};
}

std::optional<std::uint32_t> LocalisationMap::point_of(ImageId image, std::uint32_t feature) const {
    const auto found = observations_.find(image);
    if (found == observations_.end()) return std::nullopt;
    const auto at = std::ranges::lower_bound(found->second, feature, {},
                                             [](const auto& entry) { return entry.first; });
    if (at == found->second.end() || at->first != feature) return std::nullopt;
    return at->second;
}

std::vector<LocalisationMap::Vote> LocalisationMap::vote(std::span<const std::uint8_t> rows) const {
    if (packed_.rows == 0 || rows.empty()) return {};
    std::map<ImageId, double> votes;
    for (const std::uint32_t nearest : nearest_descriptors(rows, packed_)) {
        const std::vector<ImageId>& images = images_of_[sampled_points_[nearest]];
        // A point that everybody sees says little about who it is.
        const double weight = 1.0 / std::sqrt(static_cast<double>(images.size()));
        for (const ImageId image : images) votes[image] += weight;
    }
    std::vector<Vote> result;
    result.reserve(votes.size());
    for (const auto& [image, sum] : votes) result.push_back({image, sum});
    std::ranges::stable_sort(result, std::ranges::greater{}, &Vote::votes);
    return result;
}

}  // namespace psfm
