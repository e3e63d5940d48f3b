// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "storage/exchange/models/exported_model.h"

namespace psfm {

/// Points for readers that keep coordinates as 32-bit floats: the first of all those that have one
/// place there. Where a feature has two orientations there are two features, and as a rule two
/// points with the same observations, one upon the other: trainers of splats take distances between
/// neighbours, and would take these to be none.
/// @param origin  what is subtracted from places first
/// @return numbers of points, ascending. Deterministic. Thread-safe.
std::vector<std::size_t> distinct_points(std::span<const ExportedPoint> points,
                                         const Eigen::Vector3d& origin);

}  // namespace psfm
