// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/clustering/edge_weight.h"

namespace psfm {

Result<void> validate(const EdgeWeightOptions& options) {
    if (options.min_inliers < 1) {
        return Error{ErrorCode::kInvalidArgument,
                     "edge weight: min_inliers is 0; give at least 1, 30 is the default"};
    }
    return {};
}

double edge_weight(const TwoViewGeometry& geometry, const EdgeWeightOptions& options) {
    const std::size_t inliers = geometry.inliers.size();
    return inliers >= options.min_inliers ? static_cast<double>(inliers) : 0.0;
}

}  // namespace psfm
