// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "tests/stages/reconstruction/two_parts.h"

namespace psfm {

/// Photographs along a wall of which the first and the last ones make a model each; one edge joins
/// the two that no model explains. An image more, the last one, has such an edge to each of them,
/// that to the last ones of more matches.
struct TwoModels {
    static constexpr std::uint32_t kFirst = 9;   ///< images of the first model
    static constexpr std::uint32_t kSecond = 6;  ///< and of the second
    static constexpr std::uint32_t kImages = kFirst + kSecond + 1;

    synthetic::SyntheticScene scene = synthetic::make_scene(synthetic::line_along_wall(kImages), 3);
    std::vector<VerifiedPairPtr> pairs;

    TwoModels() {
        for (const VerifiedPairPtr& pair : synthetic::make_verified_pairs(scene)) {
            const auto [first, second] = pair->pair;
            const bool is_inside = (index_of(first) < kFirst) == (index_of(second) < kFirst);
            if (is_inside && index_of(second) + 1 < kImages) pairs.push_back(pair);
        }
        const VerifiedPairPtr good = pairs.front();
        add_denied(*good, {ImageId{1}, ImageId{kFirst + 1}}, 120);
        add_denied(*good, {ImageId{2}, ImageId{kImages - 1}}, 60);
        add_denied(*good, {ImageId{kFirst + 2}, ImageId{kImages - 1}}, 80);
        std::ranges::sort(pairs, {}, [](const VerifiedPairPtr& pair) { return pair->pair; });
    }

    static std::vector<ImageId> first() { return images(0, kFirst); }
    static std::vector<ImageId> second() { return images(kFirst, kFirst + kSecond); }

    static std::vector<ImageId> images(std::uint32_t from, std::uint32_t to) {
        std::vector<ImageId> images;
        for (std::uint32_t i = from; i < to; ++i) images.push_back(ImageId{i});
        return images;
    }

  private:
    /// @param good  of as many matches at least
    void add_denied(const VerifiedPair& good, ImagePair images, std::size_t matches) {
        VerifiedPair pair = good;
        pair.geometry.inliers.resize(matches);
        pairs.push_back(denied_edge(std::make_shared<const VerifiedPair>(std::move(pair)), images));
    }
};

}  // namespace psfm
