// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include "tests/synthetic/verified_pairs.h"

namespace psfm {

/// An edge that a true model denies: as many matches as another one, none of one point.
inline VerifiedPairPtr denied_edge(const VerifiedPairPtr& other, ImagePair images) {
    VerifiedPair pair{images, other->geometry};
    std::uint32_t feature = 0;
    for (FeatureMatch& match : pair.geometry.inliers) {
        match = {feature, feature};
        ++feature;
    }
    return std::make_shared<const VerifiedPair>(std::move(pair));
}

/// Photographs along a wall in two parts that one edge joins.
struct TwoParts {
    static constexpr std::uint32_t kImages = 12;
    static constexpr std::uint32_t kLeft = 8;  ///< images of the larger part, the first ones

    synthetic::SyntheticScene scene = synthetic::make_scene(synthetic::line_along_wall(kImages), 3);

    /// @param joint  matches of the edge between the parts, over those that there are
    /// @param denied  edges between the parts that the true model denies
    std::vector<VerifiedPairPtr> pairs(double joint, std::uint32_t denied) const {
        std::vector<VerifiedPairPtr> pairs;
        for (const VerifiedPairPtr& pair : synthetic::make_verified_pairs(scene)) {
            const auto [first, second] = pair->pair;
            if ((index_of(first) < kLeft) == (index_of(second) < kLeft)) pairs.push_back(pair);
            if (index_of(first) != kLeft - 1 || index_of(second) != kLeft) continue;
            VerifiedPair thin = *pair;
            auto& matches = thin.geometry.inliers;
            matches.resize(static_cast<std::size_t>(joint * static_cast<double>(matches.size())));
            pairs.push_back(std::make_shared<const VerifiedPair>(std::move(thin)));
        }
        const VerifiedPairPtr good = pairs.front();
        for (std::uint32_t i = 0; i < denied; ++i)
            pairs.push_back(denied_edge(good, {ImageId{i}, ImageId{kImages - 1 - i}}));
        std::ranges::sort(pairs, {}, [](const VerifiedPairPtr& pair) { return pair->pair; });
        return pairs;
    }
};

}  // namespace psfm
