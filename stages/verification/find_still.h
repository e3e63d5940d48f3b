// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "graph/two_view_geometry.h"
#include "stages/verification/two_view_problem.h"
#include "stages/verification/verify_options.h"

namespace psfm {

/// The matches of two photographs that lie at the same pixel in both, with the same scale and
/// orientation; of photographs of different sizes, at the same place from a corner, from the middle
/// of a side, or from the photograph's. Of ordinary pairs hardly any does; where the camera stood
/// still, or what is seen moves with the camera (a watermark, the car's hood, what stands behind a
/// turntable), many do.
/// @return ascending; empty where there are fewer than options.min_matches
/// REQUIRES: matches index the views' keypoints. Thread-safe.
std::vector<FeatureMatch> find_still(const MatchedViews& views, const StillOptions& options);

/// Whether matches lie wherever the photographs have features, as they do where the camera stood
/// still, and not in a part of them, as those of a watermark do: the part of the features of both
/// in those squares of a grid that hold such a match. A camera makes photographs of one
/// size where it stands.
/// @param still  from find_still
/// @return 0 to 1; 0 for photographs of different sizes
double still_coverage(const MatchedViews& views, std::span<const FeatureMatch> still,
                      const StillOptions& options);

/// How far the matches move between the photographs, at the median [px]; 0 without any.
double median_motion_px(const MatchedViews& views, std::span<const FeatureMatch> matches);

}  // namespace psfm
