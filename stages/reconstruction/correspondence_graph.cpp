// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/correspondence_graph.h"

#include <algorithm>
#include <optional>

namespace psfm {
namespace {

std::optional<std::uint32_t> local_index(std::span<const ImageId> images, ImageId image) {
    const auto found = std::ranges::lower_bound(images, image);
    if (found == images.end() || *found != image) return std::nullopt;
    return static_cast<std::uint32_t>(found - images.begin());
}

}  // namespace

CorrespondenceGraph::CorrespondenceGraph(std::span<const ImageId> images,
                                         std::span<const std::uint32_t> feature_counts,
                                         std::span<const VerifiedPairPtr> pairs) {
    struct LocalPair {
        std::uint32_t image1;
        std::uint32_t image2;
        const std::vector<FeatureMatch>* matches;
    };
    std::vector<LocalPair> local_pairs;
    for (const VerifiedPairPtr& pair : pairs) {
        const auto image1 = local_index(images, pair->pair.first);
        const auto image2 = local_index(images, pair->pair.second);
        if (image1 && image2) local_pairs.push_back({*image1, *image2, &pair->geometry.inliers});
    }
    std::ranges::sort(local_pairs, {},
                      [](const LocalPair& p) { return std::pair(p.image1, p.image2); });

    const auto in_range = [&](const LocalPair& pair, const FeatureMatch& match) {
        return match.first < feature_counts[pair.image1] &&
               match.second < feature_counts[pair.image2];
    };
    // Count, then fill: two passes keep every image's matches in one block of memory.
    offsets_.resize(images.size());
    targets_.resize(images.size());
    for (std::size_t i = 0; i < images.size(); ++i) offsets_[i].assign(feature_counts[i] + 1, 0);
    for (const LocalPair& pair : local_pairs) {
        std::uint32_t& count = match_counts_[{pair.image1, pair.image2}];
        for (const FeatureMatch& match : *pair.matches) {
            if (!in_range(pair, match)) continue;
            ++offsets_[pair.image1][match.first + 1];
            ++offsets_[pair.image2][match.second + 1];
            ++count;
        }
    }
    for (std::size_t i = 0; i < images.size(); ++i) {
        for (std::size_t f = 1; f < offsets_[i].size(); ++f) offsets_[i][f] += offsets_[i][f - 1];
        targets_[i].resize(offsets_[i].back());
    }
    std::vector<std::vector<std::uint32_t>> next(images.size());
    for (std::size_t i = 0; i < images.size(); ++i)
        next[i].assign(offsets_[i].begin(), offsets_[i].end() - 1);
    for (const LocalPair& pair : local_pairs) {
        for (const FeatureMatch& match : *pair.matches) {
            if (!in_range(pair, match)) continue;
            targets_[pair.image1][next[pair.image1][match.first]++] = {pair.image2, match.second};
            targets_[pair.image2][next[pair.image2][match.second]++] = {pair.image1, match.first};
        }
    }
    for (std::size_t i = 0; i < images.size(); ++i) {
        for (std::size_t f = 0; f + 1 < offsets_[i].size(); ++f) {
            std::sort(targets_[i].begin() + offsets_[i][f],
                      targets_[i].begin() + offsets_[i][f + 1]);
        }
    }
}

std::uint32_t CorrespondenceGraph::match_count(std::uint32_t image1, std::uint32_t image2) const {
    const auto found = match_counts_.find(std::minmax(image1, image2));
    return found == match_counts_.end() ? 0 : found->second;
}

}  // namespace psfm
