// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "graph/camera.h"
#include "graph/rigid3.h"
#include "tests/synthetic/photographs/photo_world.h"

namespace psfm::synthetic {

struct PhotographOptions {
    double noise_sigma = 1.5;       ///< sensor noise [grey levels]; more of it costs features
    double exposure_sigma = 0.03;   ///< relative; each photograph is a little brighter or darker
    double corner_darkening = 0.1;  ///< how much darker the corners are than the middle, 0 … 1
};

/// Directions of sight of a camera, computed once for all of its photographs: normalised
/// coordinates of the corners of its pixels, (width + 1) x (height + 1), row by row. Immutable,
/// thread-safe.
struct SightLines {
    Camera camera;
    std::vector<Eigen::Vector2f> normalized;

    /// REQUIRES: x <= width, y <= height.
    const Eigen::Vector2f& at(std::uint32_t x, std::uint32_t y) const {
        return normalized[static_cast<std::size_t>(y) * (camera.width + 1) + x];
    }
};
SightLines make_sight_lines(const Camera& camera);

/// The photograph, 8-bit BGR, stored as the sensor saw it. The centre of pixel (column, row) is at
/// (column + 0.5, row + 0.5) of graph/camera.h. Deterministic for equal arguments. Thread-safe.
cv::Mat take_photograph(const PhotoWorld& world, const SightLines& sight,
                        const Rigid3& cam_from_world, const PhotographOptions& options,
                        std::uint64_t seed);

}  // namespace psfm::synthetic
