// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "graph/result.h"
#include "graph/sim3.h"
#include "stages/algorithms/alignment/alignment_options.h"
#include "stages/algorithms/alignment/point_correspondences.h"

namespace psfm {

/// How well a similarity fits: number of correspondences within max_error, and their truncated
/// squared errors summed over all correspondences, in units of max_error^2 (MSAC, Torr & Zisserman
/// 2000).
struct Sim3Support {
    std::uint32_t inliers = 0;
    double cost = 0.0;
};
/// @param enough  not counted any further once the cost is as high: then the fit is no better
Sim3Support support_of(std::span<const EdgeCorrespondences> edges, const Sim3& b_from_a,
                       double max_error, double enough = std::numeric_limits<double>::infinity());

struct RobustSim3 {
    Sim3 b_from_a;
    Sim3Support support;
};

/// Similarity between two models by RANSAC over triples of 3D-3D correspondences, each better one
/// improved by least squares on its inliers (Chum et al. 2003).
/// @param candidates similarities to be judged first
/// @param seed of the samples; same seed, same result
/// @errors kTooFewMatches (fewer than 3 correspondences), kDegenerate (no sample gave a similarity)
Result<RobustSim3> estimate_sim3_ransac(std::span<const EdgeCorrespondences> edges,
                                        std::span<const Sim3> candidates,
                                        const ClusterConstraintOptions& options,
                                        std::uint64_t seed);

}  // namespace psfm
