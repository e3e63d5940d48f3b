// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/clustering/still_features.h"

#include <algorithm>
#include <iterator>
#include <unordered_map>

namespace psfm {
namespace {

/// Pairs that show a feature stand still while the scene moves, and move with it.
struct Votes {
    std::uint32_t still = 0;
    std::uint32_t moving = 0;
};

bool is_among(std::span<const std::uint32_t> features, std::uint32_t feature) {
    return std::ranges::binary_search(features, feature);
}

}  // namespace

Result<void> validate(const StillFeatureOptions& options) {
    if (!(options.max_moving >= 0.0 && options.min_part >= 0.0 && options.min_part <= 1.0)) {
        return Error{ErrorCode::kInvalidArgument,
                     "still features: max_moving is negative, or min_part not between 0 and 1"};
    }
    return {};
}

bool shows_motion(const TwoViewGeometry& geometry) {
    if (geometry.still.empty()) return true;
    std::vector<FeatureMatch> both;
    std::ranges::set_intersection(geometry.still, geometry.inliers, std::back_inserter(both));
    return 2 * both.size() < geometry.inliers.size();
}

std::vector<std::uint32_t> still_features(ImageId image, std::span<const VerifiedPairPtr> pairs,
                                          const StillFeatureOptions& options) {
    std::vector<std::uint32_t> features;
    if (options.min_pairs == 0) return features;
    std::unordered_map<std::uint32_t, Votes> votes;
    const auto feature_of = [&](const VerifiedPair& pair, const FeatureMatch& match) {
        return pair.pair.first == image ? match.first : match.second;
    };
    for (const VerifiedPairPtr& pair : pairs) {
        const TwoViewGeometry& geometry = pair->geometry;
        if (geometry.still.empty() || !shows_motion(geometry)) continue;
        std::vector<FeatureMatch> still;
        std::ranges::set_difference(geometry.still, geometry.inliers, std::back_inserter(still));
        for (const FeatureMatch& match : still) ++votes[feature_of(*pair, match)].still;
    }
    if (votes.empty()) return features;
    for (const VerifiedPairPtr& pair : pairs) {
        const TwoViewGeometry& geometry = pair->geometry;
        std::vector<FeatureMatch> moving;
        std::ranges::set_difference(geometry.inliers, geometry.still, std::back_inserter(moving));
        for (const FeatureMatch& match : moving) {
            if (const auto found = votes.find(feature_of(*pair, match)); found != votes.end())
                ++found->second.moving;
        }
    }
    for (const auto& [feature, count] : votes) {
        if (count.still >= options.min_pairs && count.moving <= options.max_moving * count.still)
            features.push_back(feature);
    }
    std::ranges::sort(features);
    return features;
}

VerifiedPairPtr without_still(const VerifiedPairPtr& pair, std::span<const std::uint32_t> first,
                              std::span<const std::uint32_t> second,
                              const StillFeatureOptions& options) {
    if (first.empty() && second.empty()) return pair;
    std::vector<FeatureMatch> kept;
    const std::vector<FeatureMatch>& inliers = pair->geometry.inliers;
    std::ranges::copy_if(inliers, std::back_inserter(kept), [&](const FeatureMatch& match) {
        return !is_among(first, match.first) && !is_among(second, match.second);
    });
    if (kept.size() == inliers.size()) return pair;
    if (kept.size() < options.min_inliers ||
        static_cast<double>(kept.size()) < options.min_part * static_cast<double>(inliers.size()))
        return nullptr;
    auto trimmed = std::make_shared<VerifiedPair>(*pair);
    trimmed->geometry.inliers = std::move(kept);
    return trimmed;
}

}  // namespace psfm
