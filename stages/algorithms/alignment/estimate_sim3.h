// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>

#include "graph/result.h"
#include "graph/sim3.h"

namespace psfm {

/// Similarity between two sets of points in the least-squares sense (Umeyama, PAMI 1991; the closed
/// form that Horn 1987 gives with quaternions): minimises sum of weight |target -
/// target_from_source source|^2.
/// @param source, target N >= 3 corresponding points; @param weights N non-negative weights, or
/// empty for 1
/// @errors kInvalidArgument (sizes differ, negative or non-finite values), kDegenerate (fewer than
/// three points of positive weight, or they lie on one line up to rounding) Thread-safe.
Result<Sim3> estimate_sim3(std::span<const Eigen::Vector3d> source,
                           std::span<const Eigen::Vector3d> target,
                           std::span<const double> weights = {});

}  // namespace psfm
