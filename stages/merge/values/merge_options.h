// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "graph/result.h"
#include "stages/algorithms/alignment/alignment_options.h"

namespace psfm {

/// How far photographs are trusted to have been taken level. All ours; not tuned: what hand-held
/// photographs show.
struct GravityOptions {
    /// Standard deviation of the angle between a photograph's horizontal axis and the horizon.
    /// Raised: GPS positions tilt a model more. Lowered: slanted photographs do.
    double roll_sigma_deg = 3.0;
    /// The same of the optical axis. Lowered: looking up at facades tilts a model whose cameras all
    /// look one way.
    double pitch_sigma_deg = 15.0;
    /// The direction of gravity is never trusted beyond this, however many the photographs.
    /// Lowered: a habit common to all of them tilts a model although its positions know better.
    double min_sigma_deg = 1.0;
    /// Length of the mean of all cameras' up axes along gravity, below which up is not told from
    /// down [0, 1]. Raised: more models are tried both ways up. Lowered: aerial photographs, which
    /// look straight down, stand upside-down by chance.
    double min_mean_up = 0.3;
};
Result<void> validate(const GravityOptions& options);

/// How the place of a component on the earth is found, and when it is believed.
struct GeoreferenceOptions {
    /// Standard deviation of positions, east and north [m]. Raised: short components are not
    /// referenced, wrong positions pull more. Lowered: good positions count as outliers. Phones in
    /// streets are 5 to 15 m off (GPS.gov: 4.9 m under open sky). Ours, from these.
    double horizontal_sigma_m = 5.0;
    /// The same of altitudes. Ours; not tuned: three times worse.
    double vertical_sigma_m = 15.0;
    /// Positions needed; at least 3, as two cannot contradict each other.
    std::uint32_t min_positions = 3;
    /// Part of a component's positions that must agree with its place, within
    /// inlier_sigmas. Lowered: places by chance. Ours; not tuned.
    double min_inlier_ratio = 0.5;
    /// Standard deviation of the heading [rad], and as much relative error of the scale, at most:
    /// horizontal_sigma_m over the root of the cameras' summed squared distances from their mean.
    /// Errors of positions taken within minutes are alike, so number does not stand in for
    /// distance: some two cameras must be horizontal_sigma_m over this apart, 20 m. Raised: short
    /// components jump as positions arrive. Lowered: they wait for longer. Ours; not tuned: 14
    /// degrees.
    double max_heading_sigma = 0.25;
    /// A published place is kept while the estimate is not further off than this many of its own
    /// standard errors, in place and in heading. Raised: steps are rarer and larger. 0: every
    /// version follows. Ours; not tuned.
    double hold = 1.0;
    /// A turn of less than this is kept in any case [deg]. Ours; not tuned.
    double hold_angle_deg = 2.0;
    /// Minimal samples tried. Lowered: places are missed among many wrong positions. Ours; not
    /// tuned: with half of them wrong 200 pairs all miss with a chance of 1e-25, triples with
    /// 3e-12.
    std::uint32_t samples = 200;
    /// Standard deviations within which a position agrees with a place. Raised: wrong positions
    /// pull; lowered: right ones count as outliers. Customary: 99.7 % of a Gaussian lie within.
    double inlier_sigmas = 3.0;
};
Result<void> validate(const GeoreferenceOptions& options);

struct MergeOptions {
    ClusterConstraintOptions constraint;
    PoseGraphOptions pose_graph;
    /// Place components by the positions in their photographs' files. Off: frames are never those
    /// of the earth, and gravity is not asked for.
    bool use_gps = true;
    /// Let the photographs' orientation tell up, once a component is placed by positions. Off:
    /// components whose positions are on one line are not referenced.
    bool use_gravity = true;
    GravityOptions gravity;
    GeoreferenceOptions georeference;
    /// A camera stayed where it was published if it moved by less than this part of the median
    /// distance between neighbours: the frame is that in which most stay. Raised: what drifts drags
    /// the frame along; lowered: noise decides which cameras hold it. Not tuned.
    double max_stayed_move = 0.25;
};
/// @errors kInvalidArgument
Result<void> validate(const MergeOptions& options);

}  // namespace psfm
