// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/alignment/cluster_index.h"

#include <algorithm>
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
    if (images.empty()) return;
    first_image_ = index_of(images.front());
    place_of_.assign(index_of(images.back()) - first_image_ + 1, kNotAsked);
    for (std::uint32_t place = 0; place < images.size(); ++place)
        place_of_[index_of(images[place]) - first_image_] = place;
    points_.resize(images.size());
    const auto is_asked = [&](ImageId image) { return place_of(image) != kNotAsked; };
    for (std::size_t b = 0; b < model.points.blocks().size(); ++b) {
        const PointBlock& block = *model.points.blocks()[b];
        if (std::ranges::none_of(block.images(), is_asked)) continue;
        auto p = static_cast<std::uint32_t>(model.points.first_of(b));
        for (const ScenePoint& point : block.points()) {
            for (const Observation& seen : point.track) {
                const std::uint32_t place = place_of(seen.image);
                if (place != kNotAsked) points_[place].emplace_back(seen.feature, p);
            }
            ++p;
        }
    }
    for (auto& points : points_) std::ranges::sort(points);
}

std::uint32_t ClusterIndex::place_of(ImageId image) const {
    const std::uint32_t offset = index_of(image) - first_image_;  // wraps round below the first
    return offset < place_of_.size() ? place_of_[offset] : kNotAsked;
}

std::optional<std::uint32_t> ClusterIndex::point_of(ImageId image, std::uint32_t feature) const {
    const std::uint32_t place = place_of(image);
    if (place == kNotAsked) return std::nullopt;
    const auto& points = points_[place];
    const auto found = std::ranges::lower_bound(points, feature, {},
                                                &std::pair<std::uint32_t, std::uint32_t>::first);
    if (found == points.end() || found->first != feature) return std::nullopt;
    return found->second;
}

}  // namespace psfm
