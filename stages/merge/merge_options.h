// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "graph/result.h"

namespace psfm {

/// How a similarity between two clusters is found and accepted.
struct ClusterConstraintOptions {
    /// A correspondence of 3D points agrees with a similarity when the other cluster's point,
    /// brought over, projects this close to the own one, in both images of its edge [fraction of
    /// the longer image side]. Distances in images need no scale of the scene and do not punish
    /// points for the uncertainty of their depth. Raised: wrong similarities gather inliers.
    /// Lowered: drift between clusters rejects true ones. Ours: 0.005 is 8 px in 1536.
    double max_error = 0.005;
    /// Inliers that one edge's similarity needs. Lowered: chance agreements of look-alikes. Ours.
    std::uint32_t min_edge_inliers = 8;
    /// Inliers that the final similarity of two clusters needs. Lowered: joins over thin evidence.
    /// Ours.
    std::uint32_t min_pair_inliers = 16;
    /// Part of the correspondences that must be inliers, of an edge and finally. Ours.
    double min_inlier_ratio = 0.3;
    /// Neighbourhood similarity s below which an edge is an outlier (paper: lambda_s).
    double min_neighborhood_similarity = 0.9;
    /// So many cameras may change their neighbour in any case. Where two clusters meet, the last
    /// camera of either may well be nearer to the other's; in clusters of five that alone is s =
    /// 0.8. Raised: small clusters may interleave. 0: the paper. Ours.
    std::uint32_t border_cameras = 2;
    /// Cameras stand beside each other when they are nearer than this part of the depth of what
    /// they see, and their viewing directions differ by less [deg]. As PlaceOptions. Ours.
    double companion_offset = 0.25;
    double companion_turn_deg = 25.0;
    /// Cameras beside some of another cluster without an edge to any of them, at which the two
    /// clusters cannot both stand where they do; 0: never, as in the paper. Lowered: a few pairs
    /// that were not tried keep clusters apart; raised: folds join them. Ours.
    std::uint32_t min_unmatched_cameras = 5;
    /// And their part of all that stand beside some of the other cluster, at least. Ours: those
    /// beside the one facade that two streets have are matched.
    double max_unmatched_part = 0.2;
    /// Edges looked at between two clusters, those with most correspondences first; 0: all. Raised:
    /// slower, linear. Ours: fifty edges fix seven numbers many times over.
    std::uint32_t max_edges_per_pair = 50;
    /// Chance of having drawn at least one sample without outliers [0, 1). Raised: slower.
    double confidence = 0.9999;
    /// Samples at most, whatever the confidence asks. Lowered: similarities are missed among many
    /// wrong correspondences. Ours: at min_inlier_ratio 0.3 the confidence asks for 337.
    std::uint32_t max_ransac_iterations = 1000;
};
Result<void> validate(const ClusterConstraintOptions& options);

/// How cluster poses are found from the constraints between pairs.
struct PoseGraphOptions {
    /// Residual at which the Huber loss turns linear. A residual of 1 is one radian, a factor e in
    /// scale, or a shift by the extent of the points that the constraint rests on. Raised: bad
    /// constraints pull more. Lowered: nearer to L1, slower. Ours.
    double huber_scale = 0.02;
    /// Constraints with a larger residual after optimisation are dropped, and the rest optimised
    /// again; a large value never drops. Lowered: loops that close badly by drift lose a true
    /// constraint. Ours, not in the paper.
    double max_residual = 0.3;
    std::uint32_t max_iterations = 100;  ///< of Levenberg-Marquardt
};
Result<void> validate(const PoseGraphOptions& options);

/// How far photographs are trusted to have been taken level. All ours: what hand-held photographs
/// show.
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
    /// streets are 5 to 15 m off (GPS.gov: 4.9 m under open sky). Ours.
    double horizontal_sigma_m = 5.0;
    /// The same of altitudes; ours: three times worse.
    double vertical_sigma_m = 15.0;
    /// Positions needed; at least 3, as two cannot contradict each other.
    std::uint32_t min_positions = 3;
    /// Part of a component's positions that must agree with its place, within three standard
    /// deviations. Lowered: places by chance. Ours.
    double min_inlier_ratio = 0.5;
    /// Standard deviation of the heading [rad], and as much relative error of the scale, at most:
    /// horizontal_sigma_m over the root of the cameras' summed squared distances from their mean.
    /// Errors of positions taken within minutes are alike, so number does not stand in for
    /// distance: some two cameras must be horizontal_sigma_m over this apart, 20 m. Raised: short
    /// components jump as positions arrive. Lowered: they wait for longer. Ours: 14 degrees.
    double max_heading_sigma = 0.25;
    /// A published place is kept while the estimate is not further off than this many of its own
    /// standard errors, in place and in heading. Raised: steps are rarer and larger. 0: every
    /// version follows. Ours.
    double hold = 1.0;
    /// A turn of less than this is kept in any case [deg]. Ours.
    double hold_angle_deg = 2.0;
    /// Minimal samples tried. Lowered: places are missed among many wrong positions. Ours: with
    /// half of them wrong 200 pairs all miss with a chance of 1e-25, triples with 3e-12.
    std::uint32_t samples = 200;
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
};
/// @errors kInvalidArgument
Result<void> validate(const MergeOptions& options);

}  // namespace psfm
