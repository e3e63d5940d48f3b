// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "graph/result.h"

namespace psfm {

/// When an image has to see a point since two others see it from both sides (seen_between.h). All
/// ours; figures: docs/look-alikes.md, "Seen from both sides"; which of them are not tuned stands
/// in docs/options.md.
struct BetweenOptions {
    /// The image's angles to both others add up to so much more than the angle between these, at
    /// most [deg]. Raised: points to one side of all who see them are expected, too; lowered:
    /// hardly any are.
    double slack_deg = 4.0;
    /// Angle between both others, seen from the point [deg]. Raised, the first: dense walks say
    /// less; the second: what is seen from two sides of an edge is expected between them. Not
    /// tuned.
    double min_spread_deg = 1.0;
    double max_spread_deg = 60.0;
    /// The point is larger in the image than in all that see it by this part at most, and smaller
    /// likewise: features of a zoomed photograph are not found in one that is not. Not tuned.
    double size_slack = 0.05;
    /// A point counts for the pairs of the image and those who see it from directions that differ
    /// by less [deg]. Raised: more pairs are compared, and more is lost by the way.
    double max_angle_deg = 20.0;
    /// Cells along the longer side of a photograph. A point is in sight where the image has so many
    /// points of its own in a cell and those around it, none of them nearer than this part of its
    /// depth: else something is in front, or nothing is found there at all. Not tuned.
    std::uint32_t grid = 16;
    std::uint32_t min_own = 3;
    double min_depth = 0.6;
    /// Companions that are asked with an image (companions.h), and how many of them all have to see
    /// a point before it counts. Lowered: what features lose by chance is missed; raised:
    /// companions stand beyond a fold.
    std::uint32_t companions = 4;
    std::uint32_t min_asked = 3;
    /// Points of images fewer than so many are left out: chance matches. Of longer tracks so many
    /// images are asked. Lowered, the second: fewer points are expected; raised: slower.
    std::uint32_t min_track = 3;
    std::uint32_t max_track = 24;
    /// What images within this part of the depth that one sees have seen is looked at, of the
    /// nearest so many of them. Raised: slower; lowered: less is expected.
    double max_offset = 0.5;
    std::uint32_t max_neighbors = 64;
    /// Rim of a photograph in which no point is expected, over its longer side. As in PlaceOptions.
    double margin = 0.02;
};

/// @errors kInvalidArgument
Result<void> validate(const BetweenOptions& options);

}  // namespace psfm
