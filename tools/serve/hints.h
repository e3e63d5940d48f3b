// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "graph/image.h"
#include "graph/scene.h"
#include "tools/report/edge_facts.h"

namespace psfm {

/// Where the next photograph helps most, in words for who takes it.
struct Hint {
    enum class Kind : std::uint8_t {
        kJoinParts,  ///< a pair leads from one part to another
        kLookAlike,  ///< two places look alike; what lies between tells them apart
        kFewPoints,  ///< few observations hold a camera
        kLowAngle,   ///< its points are seen from nearly one direction
    };
    Kind kind{};
    ImageId image{};  ///< where it is about
    std::string text;
};
std::string_view hint_name(Hint::Kind kind);

struct HintOptions {
    std::size_t most = 10;  ///< told at once. Higher: nobody reads them. Ours.
    /// A camera with fewer observations than this part of the median is thin. Ours.
    double few_points = 0.3;
    /// Below this median angle between a camera's rays and those of others that see the same points
    /// [deg], depths are poor. COLMAP's minimum for a first pair is 16, for a point 1.5. Ours.
    double low_angle_deg = 2.5;
};

/// Computed from the model and its pairs; the most urgent first. Cost: of all points.
/// @param names  what photographs are called, by image id
std::vector<Hint> hints_for(const Scene& scene, const std::vector<EdgeFact>& edges,
                            const std::vector<std::string>& names, const HintOptions& options = {});

}  // namespace psfm
