// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "graph/camera.h"
#include "graph/image.h"
#include "graph/rigid3.h"

namespace psfm::synthetic {

/// Uniform in [0, 1) as a function of its arguments alone, so that one choice does not shift
/// another.
double chance(std::uint64_t seed, std::uint64_t value);

/// Largest distance from the axis that the image shows, in normalised coordinates. Beyond it strong
/// distortion folds back into the image.
double field_of_view(const Camera& camera);

/// The feature that a point makes in an image; nothing when it is not in it. Blobs of 5 to 50 mm.
/// @param limit  field_of_view(camera)
/// @param point_seed  decides on size, angle and colour
std::optional<Keypoint> feature_of(const Camera& camera, double limit, const Rigid3& cam_from_world,
                                   const Eigen::Vector3d& position, std::uint64_t point_seed);

}  // namespace psfm::synthetic
