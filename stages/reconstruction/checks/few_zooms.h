// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <vector>

#include "stages/reconstruction/checks/tied_model.h"

namespace psfm {

/// Which zoom each camera has, of so many: they are parted by their own focal lengths such that
/// the logarithms vary least within the parts, exactly. A camera counts by how sure its focal
/// length is: what it gains by the square of the step to it (half the curvature of its loss).
/// @param zooms  at least 1
/// @return by camera, below `zooms`; empty: there are fewer cameras than zooms
std::vector<std::size_t> part_by_zoom(std::span<const ReleasedCamera> cameras, std::size_t zooms);

/// The fewest zooms that explain the cameras of a kind, from two on to TieOptions::max_zooms: they
/// are parted by zoom; then each gets the one that explains its images best: a focal length that is
/// not sure by itself is so when it is one of two. Cameras that still deviate have a zoom of their
/// own, and count.
/// @param apart  each by itself
/// @param labels  of all cameras of the problem, by which others are tied
/// @return the zoom of each; empty: there are more than half as many as cameras
std::map<CameraId, std::size_t> find_zooms(std::span<const ReleasedCamera> cameras,
                                           const TiedModel& apart, const ClusterProblem& problem,
                                           const std::map<CameraId, std::size_t>& labels,
                                           const TieOptions& options);

}  // namespace psfm
