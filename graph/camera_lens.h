// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "graph/camera.h"

namespace psfm {

/// The same camera with the focal lengths and the distortion of another one, and what is known of
/// these: a camera that was turned has another principal point and size.
Camera with_lens_of(Camera camera, const Camera& other);

}  // namespace psfm
