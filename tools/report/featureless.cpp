// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/report/featureless.h"

namespace psfm {
namespace {

/// Format: which reason people are told: a photograph with fewer features matches nothing. A pair
/// takes 15 matches, and one feature in five or ten of an easy pair is one.
constexpr std::size_t kFewFeatures = 100;

}  // namespace

void find_featureless(const SessionReader& store, std::span<const Image> images,
                      std::vector<std::pair<ImageId, WaitReason>>& waiting) {
    for (auto& [image, reason] : waiting) {
        if (reason != WaitReason::kTooFewMatches || index_of(image) >= images.size()) continue;
        const auto keypoints = store.keypoints(image);
        // Expected: damaged ones are not told of here, but by `psfm check`
        if (keypoints.ok() && (*keypoints)->size() < kFewFeatures)
            reason = WaitReason::kTooFewFeatures;
    }
}

}  // namespace psfm
