// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/merge/cluster_index.h"

#include <utility>

namespace psfm {

ClusterIndex::ClusterIndex(const Reconstruction& model, std::span<const ImageId> images)
    : model_(&model) {
    std::vector<Eigen::Vector3d> centres;
    centres.reserve(model.images.size());
    for (const RegisteredImage& image : model.images) {
        centres.push_back(image.cam_from_cluster.target_origin_in_source());
    }
    centres_ = KdTree(std::move(centres));
    neighbor_distances_.reserve(centres_.size());
    for (std::size_t k = 0; k < centres_.size(); ++k) {
        neighbor_distances_.push_back(centres_.nearest_distance(centres_.points()[k], k));
    }
    for (const ImageId image : images) points_[image];
    for (std::uint32_t p = 0; p < model.points.size(); ++p) {
        for (const Observation& seen : model.points[p].track) {
            const auto found = points_.find(seen.image);
            if (found != points_.end()) found->second.emplace(seen.feature, p);
        }
    }
}

std::optional<std::uint32_t> ClusterIndex::point_of(ImageId image, std::uint32_t feature) const {
    const auto points = points_.find(image);
    if (points == points_.end()) return std::nullopt;
    const auto point = points->second.find(feature);
    if (point == points->second.end()) return std::nullopt;
    return point->second;
}

}  // namespace psfm
