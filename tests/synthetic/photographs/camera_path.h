// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "tests/synthetic/scene.h"

namespace psfm::synthetic {

/// Poses along a path, cam_from_world, in order.
std::vector<Rigid3> make_poses(const CameraOptions& options, std::uint64_t seed);

/// Intrinsics as the options say, the focal length times `focal_factor`, the principal point
/// centred.
Camera make_true_camera(const CameraOptions& options, double focal_factor);

}  // namespace psfm::synthetic
