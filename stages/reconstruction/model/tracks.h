// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

#include "stages/reconstruction/model/estimate_point.h"
#include "stages/reconstruction/model/working_model.h"

namespace psfm {

/// Continues points into an image and creates new ones from its matches.
/// @return observations added
std::size_t triangulate_image(WorkingModel& model, std::uint32_t image,
                              const TrackOptions& options);

/// Points that one of the images sees, or all points when there are none; ascending.
std::vector<std::uint32_t> points_seen_by(const WorkingModel& model,
                                          std::span<const std::uint32_t> images);

// The following look at points_seen_by() images.

/// Adds observations that matches lead to and that fit: registered images that were added after the
/// point, or whose pose has become better since. @return observations added
std::size_t complete_tracks(WorkingModel& model, std::span<const std::uint32_t> images,
                            const TrackOptions& options);

/// Joins points that matches connect, with any others, and that one position explains.
/// @return observations of joined points
std::size_t merge_tracks(WorkingModel& model, std::span<const std::uint32_t> images,
                         const TrackOptions& options);

/// Removes observations with too large an error and points with too small an angle. Of points that
/// have not changed only the observations of `images` are looked at: the others' errors are what
/// they were. @return observations removed
std::size_t filter_tracks(WorkingModel& model, std::span<const std::uint32_t> images,
                          const TrackOptions& options);

}  // namespace psfm
