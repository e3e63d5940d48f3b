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
    /// Lowered: drift between clusters rejects true ones. Ours; not tuned:
    /// 0.005 is 8 px in 1536.
    double max_error = 0.005;
    /// Inliers that one edge's similarity needs. Lowered: chance agreements of look-alikes. Ours;
    /// not tuned.
    std::uint32_t min_edge_inliers = 8;
    /// Inliers that the final similarity of two clusters needs. Lowered: joins over thin evidence.
    /// Ours; not tuned.
    std::uint32_t min_pair_inliers = 16;
    /// Part of the correspondences that must be inliers, of an edge and finally. Ours; not tuned.
    double min_inlier_ratio = 0.3;
    /// Neighbourhood similarity s below which an edge is an outlier (paper: lambda_s).
    double min_neighborhood_similarity = 0.9;
    /// So many cameras may change their neighbour in any case. Where two clusters meet, the last
    /// camera of either may well be nearer to the other's; in clusters of five that alone is s =
    /// 0.8. Raised: small clusters may interleave. 0: the paper. Ours, for clusters of five; not
    /// tuned.
    std::uint32_t border_cameras = 2;
    /// Cameras stand beside each other when they are nearer than this part of the depth of what
    /// they see, and their viewing directions differ by less [deg]. As PlaceOptions has them
    /// (docs/look-alikes.md, "Places").
    double companion_offset = 0.25;
    double companion_turn_deg = 25.0;
    /// Cameras beside some of another cluster without an edge to any of them, at which the two
    /// clusters cannot both stand where they do; 0: never, as in the paper. Lowered: a few pairs
    /// that were not tried keep clusters apart; raised: folds join them. Ours, on the simulated
    /// town (docs/look-alikes.md, "Places").
    std::uint32_t min_unmatched_cameras = 5;
    /// And their part of all that stand beside some of the other cluster, at least. Ours: those
    /// beside the one facade that two streets have are matched (docs/look-alikes.md, "Places").
    double max_unmatched_part = 0.2;
    /// A weak edge counts as one here if it has this part of the inliers of the best edge of either
    /// of its images; 0: each one counts. Raised: in streams of video, where most true pairs are
    /// weak, right parts are kept apart; lowered: look-alikes match cameras. Ours, on quad-streams
    /// (docs/notebook/2026-11-30-a-joint-of-look-alikes.md).
    double min_weak_part = 0.2;
    /// Edges looked at between two clusters, those with most correspondences first; 0: all. Raised:
    /// slower, linear. Ours; not tuned: fifty edges fix seven numbers
    /// many times over.
    std::uint32_t max_edges_per_pair = 50;
    /// Similarities of single edges, those of the strongest, that the final one may start from
    /// beside random samples. Raised: slower; lowered: it is left to chance where most edges are
    /// wrong. Not tuned.
    std::uint32_t edges_as_starts = 10;
    /// Where the final refinement's Huber loss bends, as a part of max_error: that counts as three
    /// standard deviations. Raised: what only just agrees pulls more; lowered: nearer to L1,
    /// slower. Ours; not tuned.
    double loss_part = 1.0 / 3.0;
    /// Chance of having drawn at least one sample without outliers [0, 1). Raised: slower. Ours;
    /// not tuned.
    double confidence = 0.9999;
    /// Samples at most, whatever the confidence asks. Lowered: similarities are missed among many
    /// wrong correspondences. Ours; not tuned: at min_inlier_ratio 0.3 the confidence asks for 337.
    std::uint32_t max_ransac_iterations = 1000;
};
Result<void> validate(const ClusterConstraintOptions& options);

/// How cluster poses are found from the constraints between pairs.
struct PoseGraphOptions {
    /// Residual at which the Huber loss turns linear. A residual of 1 is one radian, a factor e in
    /// scale, or a shift by the extent of the points that the constraint rests on. Raised: bad
    /// constraints pull more. Lowered: nearer to L1, slower. Ours; not tuned.
    double huber_scale = 0.02;
    /// Constraints with a larger residual after optimisation are dropped, and the rest optimised
    /// again; a large value never drops. Lowered: loops that close badly by drift lose a true
    /// constraint. Ours, not in the paper; not tuned.
    double max_residual = 0.3;
    std::uint32_t max_iterations = 100;  ///< of Levenberg-Marquardt
    /// Of these while it is only asked which constraints are bad, at most, and the part of the cost
    /// by which the last of them lowers it. More of them, by a smaller part: slower; the other way:
    /// good constraints look bad that have not come to rest yet. Ours, on merge_bench with copied
    /// facades.
    std::uint32_t rough_iterations = 10;
    double rough_tolerance = 1e-3;
};
Result<void> validate(const PoseGraphOptions& options);

}  // namespace psfm
