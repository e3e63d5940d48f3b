// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/two_view/invert_two_view_geometry.h"

#include <Eigen/LU>
#include <algorithm>

namespace psfm {

TwoViewGeometry invert(const TwoViewGeometry& geometry) {
    TwoViewGeometry inverted = geometry;
    const bool epipolar =
        geometry.kind == TwoViewKind::kEssential || geometry.kind == TwoViewKind::kFundamental;
    if (epipolar) {
        inverted.matrix = geometry.matrix.transpose();
    } else {
        // The inverse up to scale is the adjugate; Eigen's 3x3 inverse is that over the
        // determinant.
        inverted.matrix = geometry.matrix.inverse().normalized();
    }
    inverted.cam2_from_cam1 = inverse(geometry.cam2_from_cam1);
    for (std::vector<FeatureMatch>* matches : {&inverted.inliers, &inverted.still}) {
        for (FeatureMatch& match : *matches) std::swap(match.first, match.second);
        std::ranges::sort(*matches);
    }
    return inverted;
}

}  // namespace psfm
