// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/synthetic/scene.h"

namespace psfm {

/// Two streets as a model shows them that was folded by the facade that both have: images with even
/// ids walk along the first, those with odd ids along the second, side by side and in the same
/// frame. Every second point of the middle `copied` part of the wall is the same in both; of the
/// others each street has its own, at the same places.
/// @param copied  0 ... 1
inline synthetic::SyntheticScene two_streets(std::uint32_t images, double copied,
                                             std::uint64_t seed) {
    synthetic::SceneOptions options = synthetic::line_along_wall(images);
    // Steps of half a metre, 6 m before the wall: each image stands beside the next two at least.
    const double half = 0.25 * images;
    options.cameras.radius = half;
    options.points.extent.x() = 2.0 * half + 8.0;
    synthetic::SyntheticScene scene = synthetic::make_scene(options, seed);
    const auto count = static_cast<std::uint32_t>(scene.points.size());
    const std::vector<synthetic::SurfacePoint> own = scene.points;
    scene.points.insert(scene.points.end(), own.begin(), own.end());
    for (std::size_t image = 1; image < scene.images.size(); image += 2) {
        for (std::uint32_t& point : scene.images[image].feature_point) {
            if (point == synthetic::kNoPoint) continue;
            const bool on_copy = std::abs(scene.points[point].position.x()) <= copied * half;
            if (!on_copy || point % 2 == 1) point += count;
        }
    }
    return scene;
}

}  // namespace psfm
