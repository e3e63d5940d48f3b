// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "graph/result.h"

namespace psfm {

/// What a model has to be, to be one, and to be more than a weak one. All ours: what turns are told
/// by was tuned on datasets/cases, and not further; docs/options.md says what is not tuned at all.
struct AssessmentOptions {
    /// Turns of the camera by less say nothing [deg]: a short step past a plane, seen through an
    /// unknown focal length, looks like one. Raised: depth is invented; lowered: flights over flat
    /// land give up their models.
    double min_turn_deg = 10.0;
    /// A turn contradicts a model that shows its points from directions that differ by more [deg].
    /// Matches of a turn are within 0.3 at a focal length of 1,000 px.
    double max_turn_parallax_deg = 2.0;
    /// And its homography stretches rays by this part at most, with the model's focal lengths.
    /// Raised: flights over flat land give up their models; lowered: turns whose focal length came
    /// out wrong count for steps. Not tuned.
    double max_turn_stretch = 0.1;
    /// A model has invented its depth when it contradicts more than this part of such turns, by
    /// inliers; 0: none has, as in the paper.
    double max_invented = 0.5;
    /// As long as turns are this part of its edges, by inliers. Raised: panoramas whose turns are
    /// seldom recognised keep their invented depth; lowered: a few wrong labels decide.
    double min_turns = 0.2;
    /// Angle between the outermost directions to a point, at the median, below which a model is
    /// weak [deg]. COLMAP's 1.5 is the least that a point has.
    double weak_angle_deg = 3.0;
    /// Points seen by an image, at the median, below which it is.
    std::uint32_t weak_points = 50;
    /// Points in common by which two parts of it have to hang together.
    std::uint32_t joint_points = 15;
    /// Focal lengths over the longer side of the photograph that cameras have: views of 120 to 10
    /// degrees, and of cameras with photographs of one size within this factor of their median.
    double min_relative_focal = 0.29;
    double max_relative_focal = 5.7;
    double max_focal_factor = 1.6;
};

/// @errors kInvalidArgument
Result<void> validate(const AssessmentOptions& options);

}  // namespace psfm
