// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "graph/camera_lens.h"

#include <cstddef>

namespace psfm {

Camera with_lens_of(Camera camera, const Camera& other) {
    const Eigen::Vector2d centre = camera.principal_point();
    camera.model = other.model;
    camera.params = other.params;
    camera.focal_source = other.focal_source;
    const std::size_t first = camera.has_two_focals() ? 2 : 1;
    camera.params.at(first) = centre.x();
    camera.params.at(first + 1) = centre.y();
    return camera;
}

}  // namespace psfm
