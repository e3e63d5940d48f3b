// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "graph/ids.h"
#include "graph/reconstruction.h"
#include "graph/two_view_geometry.h"

namespace psfm {

/// Which features of a cluster's images are matched with which: the verified matches of the local
/// graph, looked up by feature. Images are addressed by their position in the cluster ("local
/// index"). An image's matches are gathered when they are first asked for: a solve that adds one
/// image to five hundred looks at few of the others. Not thread-safe; owned by one solve.
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

    std::size_t image_count() const { return feature_counts_.size(); }
    std::uint32_t feature_count(std::uint32_t image) const { return feature_counts_[image]; }
    /// Direct matches of a feature, ascending by image.
    std::span<const Feature> matches(const Feature& feature) const {
        const Matches& all = gathered(feature.image);
        const std::uint32_t first = all.offsets[feature.feature];
        return std::span(all.targets).subspan(first, all.offsets[feature.feature + 1] - first);
    }

    /// Gathers what matches() will be asked for, beside one another: reading the matches of these
    /// images is then safe from any number of threads.
    void gather(std::span<const std::uint32_t> images) const;
    /// Gives back the memory of what was gathered; who asks again waits again. Spans that matches()
    /// has returned are void.
    void forget() const;

  private:
    struct Partner {
        std::uint32_t image = 0;
        bool is_first = false;  ///< of the pair
        VerifiedPairPtr pair;
    };
    struct Matches {
        std::vector<std::uint32_t> offsets;  ///< feature_count + 1 positions in targets; empty
                                             ///< until they are gathered
        std::vector<Feature> targets;
    };
    const Matches& gathered(std::uint32_t image) const {
        if (matches_[image].offsets.empty()) gather(image);
        return matches_[image];
    }
    void gather(std::uint32_t image) const;

    std::vector<std::uint32_t> feature_counts_;
    std::vector<std::vector<Partner>> partners_;  ///< by image, ascending
    mutable std::vector<Matches> matches_;        ///< by image
};

}  // namespace psfm
