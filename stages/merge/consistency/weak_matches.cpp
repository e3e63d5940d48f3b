// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/merge/consistency/weak_matches.h"

#include <algorithm>

namespace psfm {

bool WeakMatches::match(const VerifiedPair& weak) {
    const std::size_t best =
        std::min(most_inliers(weak.pair.first), most_inliers(weak.pair.second));
    return static_cast<double>(weak.geometry.inliers.size()) >=
           min_part_ * static_cast<double>(best);
}

std::size_t WeakMatches::most_inliers(ImageId image) {
    const auto [known, is_new] = most_.try_emplace(image, 0);
    if (is_new) {
        for (const ViewGraph::Edge& edge : graph_->edges(image))
            known->second = std::max(known->second, edge.pair->geometry.inliers.size());
    }
    return known->second;
}

}  // namespace psfm
