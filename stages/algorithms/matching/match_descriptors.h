// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "graph/image.h"
#include "graph/result.h"
#include "graph/two_view_geometry.h"
#include "stages/algorithms/matching/dot_kernel.h"

namespace psfm {

struct MatchOptions {
    /// Nearest over second nearest Euclidean distance, in (0, 1]; asked in both directions. Lower:
    /// fewer matches in repetitive scenes; higher: more wrong ones. COLMAP 3.8
    /// (SiftMatching.max_ratio, there on angles), Lowe, IJCV 2004, section 7.1.
    double max_ratio = 0.8;
    /// Largest distance of two descriptors taken to length 1, in (0, 2]. Lower: matches under
    /// changes of viewpoint and light are lost; higher: more wrong ones. COLMAP 3.8
    /// (SiftMatching.max_distance).
    double max_distance = 0.7;
};

/// @errors kInvalidArgument
Result<void> validate(const MatchOptions& options);

/// The descriptors of one image in the order that the kernels read them, for matching one image
/// with many. Value; immutable after pack(), so threads may share it. As large as the descriptors
/// themselves.
struct PackedDescriptors {
    std::size_t rows = 0;
    std::vector<Strip> strips;
    std::vector<std::int32_t> norms;  ///< squared Euclidean norms, one a row
};

/// Linear in the rows: about 2 % of one match of the same size.
PackedDescriptors pack(const Descriptors& descriptors);

/// Mutual nearest neighbours that pass the ratio test in both directions and the distance limit.
/// Distances are exact: |a|^2 + |b|^2 - 2 a.b in integers. Among equally near neighbours the one
/// with the lower index is the nearest, so that equal neighbours fail the ratio test whenever
/// max_ratio <= 1. A side of one descriptor has no second neighbour, and passes the ratio test. The
/// instruction set is chosen at run time and never changes the result; neither does swapping a and
/// b, except for swapping first and second.
/// @return ascending by first; each feature at most once a side. Empty when either side is.
/// REQUIRES: validate(options). Thread-safe; runs on the calling thread alone.
std::vector<FeatureMatch> match_descriptors(const Descriptors& a, const Descriptors& b,
                                            const MatchOptions& options);
/// As above with b packed already: pack the image that stays the same.
std::vector<FeatureMatch> match_descriptors(const Descriptors& a, const PackedDescriptors& b,
                                            const MatchOptions& options);

}  // namespace psfm
