// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "graph/ids.h"
#include "graph/reconstruction.h"
#include "graph/two_view_geometry.h"

namespace psfm {

/// Which features of a cluster's images are matched with which: the verified matches of the local
/// graph, looked up by feature. Images are addressed by their position in the cluster ("local
/// index"). Immutable after construction; thread-safe for reading.
class CorrespondenceGraph {
  public:
    /// A feature of the image with this local index.
    struct Feature {
        std::uint32_t image = 0;
        std::uint32_t feature = 0;
        auto operator<=>(const Feature&) const = default;
    };

    /// @param images          the cluster's members, ascending
    /// @param feature_counts  number of features of each
    /// @param pairs           edges among them; matches beyond the feature counts are ignored
    CorrespondenceGraph(std::span<const ImageId> images,
                        std::span<const std::uint32_t> feature_counts,
                        std::span<const VerifiedPairPtr> pairs);

    std::size_t image_count() const { return offsets_.size(); }
    std::uint32_t feature_count(std::uint32_t image) const {
        return static_cast<std::uint32_t>(offsets_[image].size() - 1);
    }
    /// Direct matches of a feature, ascending by image.
    std::span<const Feature> matches(const Feature& feature) const {
        const std::vector<std::uint32_t>& offsets = offsets_[feature.image];
        return std::span(targets_[feature.image])
            .subspan(offsets[feature.feature],
                     offsets[feature.feature + 1] - offsets[feature.feature]);
    }
    /// Matches between two images, over all features.
    std::uint32_t match_count(std::uint32_t image1, std::uint32_t image2) const;

  private:
    std::vector<std::vector<std::uint32_t>>
        offsets_;  // per image: feature_count + 1 positions in targets_
    std::vector<std::vector<Feature>> targets_;
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> match_counts_;
};

}  // namespace psfm
