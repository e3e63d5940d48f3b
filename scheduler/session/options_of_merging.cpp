// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <array>

#include "scheduler/session/named_options.h"

namespace psfm {
namespace {

// How one cluster's points are brought onto another's: of clusters that are merged, and of models
// that are joined.
// NOLINTBEGIN(bugprone-macro-parentheses): FIELD is a path of members
#define PSFM_CONSTRAINT_OPTIONS(FIELD)                                                             \
    PSFM_OPTION(FIELD.max_error, 1e-5, 1,                                                          \
                "image distance at which two clusters' points agree, over the longer side",        \
                "ours; not tuned: 8 px in 1536"),                                                  \
        PSFM_OPTION(FIELD.min_edge_inliers, 3, kCount, "inliers that one edge's similarity needs", \
                    "ours; not tuned"),                                                            \
        PSFM_OPTION(FIELD.min_pair_inliers, 3, kCount,                                             \
                    "inliers that two clusters' similarity needs", "ours; not tuned"),             \
        PSFM_OPTION(FIELD.min_inlier_ratio, 0, 1,                                                  \
                    "part of the correspondences that have to agree", "ours; not tuned"),          \
        PSFM_OPTION(FIELD.min_neighborhood_similarity, 0, 1,                                       \
                    "similarity of neighbourhoods below which an edge between clusters is wrong",  \
                    "paper: lambda_s"),                                                            \
        PSFM_OPTION(FIELD.border_cameras, 0, kCount,                                               \
                    "cameras that may change their neighbour in any case; 0: none",                \
                    "ours; not tuned: clusters of five; paper: 0"),                                \
        PSFM_OPTION(                                                                               \
            FIELD.companion_offset, 0, 100,                                                        \
            "distance of cameras that stand beside each other, over the depth of what they see",   \
            "solve.places.max_offset"),                                                            \
        PSFM_OPTION(FIELD.companion_turn_deg, 0, 180, "and their turn [deg]",                      \
                    "solve.places.max_turn_deg"),                                                  \
        PSFM_OPTION(                                                                               \
            FIELD.min_unmatched_cameras, 0, kCount,                                                \
            "cameras without an edge to those beside them that keep clusters apart; 0: never",     \
            "ours, on the simulated town; docs/look-alikes.md, \"Places\"; paper: 0"),             \
        PSFM_OPTION(FIELD.max_unmatched_part, 0, 1,                                                \
                    "and their part of all that stand beside some",                                \
                    "ours, on the simulated town; docs/look-alikes.md, \"Places\""),               \
        PSFM_OPTION(FIELD.max_edges_per_pair, 0, kCount,                                           \
                    "edges looked at between two clusters; 0: all",                                \
                    "ours; not tuned: fifty fix seven numbers"),                                   \
        PSFM_OPTION(FIELD.confidence, 0, 0.999999999,                                              \
                    "chance of one clean sample at which RANSAC stops", "ours; not tuned"),        \
        PSFM_OPTION(FIELD.max_ransac_iterations, 1, kCount, "samples at most",                     \
                    "ours; not tuned: three times the 337 that the confidence asks for"),          \
        PSFM_OPTION(FIELD.edges_as_starts, 0, kCount,                                              \
                    "similarities of single edges that the final one may start from",              \
                    "ours; not tuned"),                                                            \
        PSFM_OPTION(FIELD.loss_part, 1e-6, 1,                                                      \
                    "part of max_error at which the final refinement's loss bends",                \
                    "ours; not tuned: max_error is three standard deviations")
// NOLINTEND(bugprone-macro-parentheses)

// clang-format off
constexpr std::array kMergingOptions{
    PSFM_CONSTRAINT_OPTIONS(merge.constraint),
    PSFM_OPTION(merge.constraint.min_weak_part, 0, 1, "part of the inliers of the best edge of either of its images by which a weak edge counts as one here", "ours, on quad-streams; docs/notebook, a joint of look-alikes"),
    PSFM_CONSTRAINT_OPTIONS(solve.transfer),
    PSFM_OPTION(merge.pose_graph.huber_scale, 1e-6, 1000, "residual at which the pose graph's loss turns linear", "ours; not tuned"),
    PSFM_OPTION(merge.pose_graph.max_iterations, 1, kCount, "steps of the pose graph", "ours; not tuned"),
    PSFM_OPTION(merge.pose_graph.max_residual, 1e-6, 1e9, "residual above which a constraint is dropped", "ours; not tuned"),
    PSFM_OPTION(merge.pose_graph.rough_iterations, 1, kCount, "steps while it is asked which constraints are bad", "ours; merge_bench"),
    PSFM_OPTION(merge.pose_graph.rough_tolerance, 0, 1, "and the part of the cost by which the last of them lowers it", "ours; merge_bench"),
    PSFM_OPTION(merge.max_stayed_move, 1e-06, 1000, "move of a camera that stayed, over the distance of neighbours", "ours; not tuned"),
    PSFM_OPTION(merge.use_gps, 0, 1, "parts are placed by the positions in photographs' files", "paper, \"Cluster Pose Estimation\", as an addition; docs/georeferencing.md"),
    PSFM_OPTION(merge.use_gravity, 0, 1, "photographs' orientation tells up", "paper, \"Cluster Pose Estimation\", as an addition; docs/georeferencing.md"),
    PSFM_OPTION(merge.gravity.min_mean_up, 0, 1, "how alike up is for all cameras before it is told from down", "ours; not tuned"),
    PSFM_OPTION(merge.gravity.min_sigma_deg, 0.001, 90, "standard deviation of gravity at least [deg]", "ours; not tuned"),
    PSFM_OPTION(merge.gravity.pitch_sigma_deg, 0.001, 180, "standard deviation of the optical axis from the horizon [deg]", "ours; not tuned"),
    PSFM_OPTION(merge.gravity.roll_sigma_deg, 0.001, 180, "standard deviation of the horizontal axis from it [deg]", "ours; not tuned"),
    PSFM_OPTION(merge.georeference.hold, 0, 1000, "standard errors by which a published place is kept; 0: it follows each version", "ours; not tuned"),
    PSFM_OPTION(merge.georeference.hold_angle_deg, 0, 180, "turn that is kept in any case [deg]", "ours; not tuned"),
    PSFM_OPTION(merge.georeference.horizontal_sigma_m, 0.001, 1e5, "standard deviation of positions, east and north [m]", "GPS.gov: 4.9 m under open sky"),
    PSFM_OPTION(merge.georeference.inlier_sigmas, 0.1, 1000, "standard deviations within which a position agrees with a place", "customary"),
    PSFM_OPTION(merge.georeference.max_heading_sigma, 1e-4, 10, "standard deviation of the heading at most [rad]", "ours; not tuned: 14 degrees"),
    PSFM_OPTION(merge.georeference.min_inlier_ratio, 0, 1, "part of a part's positions that have to agree with its place", "ours; not tuned"),
    PSFM_OPTION(merge.georeference.min_positions, 3, kCount, "positions that a place needs", "two cannot contradict each other"),
    PSFM_OPTION(merge.georeference.samples, 1, kCount, "minimal samples tried", "ours; not tuned: all miss with a chance of 3e-12"),
    PSFM_OPTION(merge.georeference.vertical_sigma_m, 0.001, 1e5, "standard deviation of altitudes [m]", "ours; not tuned: three times worse"),
};
// clang-format on
#undef PSFM_CONSTRAINT_OPTIONS

}  // namespace

std::span<const NamedOption> options_of_merging() {
    return kMergingOptions;
}

}  // namespace psfm
