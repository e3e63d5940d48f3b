// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>

#include "graph/result.h"
#include "graph/sim3.h"

namespace psfm {

/// A least-squares similarity, and whether the points leave a turn about their common line free.
struct SimilarityFit {
    Sim3 target_from_source;
    bool collinear = false;  ///< then the turn about the line is arbitrary
};

/// The similarity that minimises sum |target_i - S source_i|^2.
/// Method: Umeyama, Least-squares estimation of transformation parameters between two point
/// patterns, PAMI 1991, eq. 39-43.
/// @param source, target  N >= 2 points, source[i] ~ target[i]
/// @errors kTooFewMatches (N < 2), kDegenerate (either side's points coincide, or no positive scale
/// fits) Deterministic. Thread-safe.
Result<SimilarityFit> fit_similarity(std::span<const Eigen::Vector3d> source,
                                     std::span<const Eigen::Vector3d> target);

}  // namespace psfm
