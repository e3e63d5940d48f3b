// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "graph/result.h"
#include "graph/sim3.h"

namespace psfm {

struct RobustAlignmentOptions {
    /// Triples drawn when there are more than that. Raised: slower (about 10 ms a thousand for
    /// 1,000 points); lowered: a small consensus is missed. Ours: with 80 % outliers a draw is
    /// clean with probability 0.8 %, so 5,000 draws miss all of them with probability 4e-18. At or
    /// below this number of triples (32 points) all are tried.
    std::uint32_t max_triples = 5000;
    std::uint64_t seed = 0;
};
Result<void> validate(const RobustAlignmentOptions& options);

struct RobustAlignment {
    Sim3 target_from_source;
    std::vector<std::uint32_t> inliers;  ///< points that the final fit was made from, ascending
    bool consensus = true;   ///< false: no three points agree, so all were fitted together
    bool collinear = false;  ///< the turn about the inliers' line is arbitrary
};

/// Similarity between two point lists of which some correspondences are wrong: RANSAC over triples
/// with local optimisation (Chum, Matas, Kittler, Locally optimized RANSAC, DAGM 2003), then least
/// squares on the inliers. The consensus of most inliers wins; of two equal ones, that with the
/// smaller sum of squared inlier distances.
/// @param source, target  N points, source[i] ~ target[i]
/// @param inlier_threshold  largest distance of an inlier, in the target's units
/// @errors kTooFewMatches (N < 3), kDegenerate (the points of one side coincide),
///         kInvalidArgument (threshold not positive)
/// Deterministic for equal inputs and seed; the order of the points matters only where draws
/// differ. Thread-safe.
Result<RobustAlignment> align_robustly(std::span<const Eigen::Vector3d> source,
                                       std::span<const Eigen::Vector3d> target,
                                       double inlier_threshold,
                                       const RobustAlignmentOptions& options = {});

}  // namespace psfm
