// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <array>

#include "scheduler/session/named_options.h"

namespace psfm {
namespace {

// NOLINTBEGIN(bugprone-macro-parentheses): FIELD is a path of members
#define PSFM_ADJUSTMENT_OPTIONS(FIELD, LOSS_FROM, FROM)                                           \
    PSFM_OPTION(FIELD.loss_scale_px, 1e-4, 1000,                                                  \
                "residual from which an observation loses weight [px]", LOSS_FROM),               \
        PSFM_OPTION(FIELD.max_iterations, 1, 1e6, "iterations at most", FROM),                    \
        PSFM_OPTION(FIELD.function_tolerance, 0, 1,                                               \
                    "a step that lowers the cost by a smaller part is the last",                  \
                    "ours; not tuned; Ceres: 1e-6, COLMAP 3.8: 0"),                               \
        PSFM_OPTION(FIELD.max_reduced_mib, 0, kCount,                                             \
                    "memory of the reduced system up to which it is formed point by point [MiB]", \
                    "ours; docs/performance.md"),                                                 \
        PSFM_OPTION(                                                                              \
            FIELD.sigma_per_scale, 0, 100,                                                        \
            "standard deviation of an observation over its feature's scale; 0: all count alike",  \
            "ours, on Strecha's scenes; docs/accuracy.md"),                                       \
        PSFM_OPTION(                                                                              \
            FIELD.principal_point_sigma, 1e-6, 10,                                                \
            "standard deviation of a principal point from the centre, over the longer side",      \
            "ours: Strecha's cameras have 0.007; docs/accuracy.md")

#define PSFM_REFINEMENT_OPTIONS(FIELD, FROM)                                                     \
    PSFM_ADJUSTMENT_OPTIONS(FIELD.adjustment, FROM, FROM),                                       \
        PSFM_OPTION(FIELD.max_rounds, 1, 1000,                                                   \
                    "rounds of completing, adjusting and filtering at most", FROM),              \
        PSFM_OPTION(FIELD.max_change, 0, 1,                                                      \
                    "a round by which a smaller part of the observations comes or goes is last", \
                    "COLMAP 3.8"),                                                               \
        PSFM_OPTION(FIELD.round_tolerance, 0, 1,                                                 \
                    "function_tolerance of the rounds before the last, where it is larger",      \
                    "ours; docs/accuracy.md"),                                                   \
        PSFM_OPTION(FIELD.images_for_principal_point, 0, kCount,                                 \
                    "images that share a camera for its principal point to be free; 0: never",   \
                    "ours, on Strecha's scenes; docs/accuracy.md"),                              \
        PSFM_OPTION(FIELD.points_per_image, 0, kCount,                                           \
                    "points adjusted together with the cameras, seen by each image; 0: all",     \
                    "ours; docs/accuracy.md"),                                                   \
        PSFM_OPTION(FIELD.thin_from_images, 0, kCount, "images from which only so many are",     \
                    "ours; docs/accuracy.md"),                                                   \
        PSFM_OPTION(FIELD.noise.loss, 0, 1000,                                                   \
                    "width of the adjustment's loss, in noises of the model; 0: loss_scale_px",  \
                    "ours, on castle-P19; docs/notebook, noise"),                                \
        PSFM_OPTION(FIELD.noise.max_error, 0, 1000,                                              \
                    "error of an observation that is kept, in noises of the model; 0: "          \
                    "solve.tracks.max_error_px",                                                 \
                    "ours, on brighton; docs/notebook, noise"),                                  \
        PSFM_OPTION(FIELD.noise.min_loss_px, 1e-6, 1000, "least width of that loss [px]",        \
                    "ours; not tuned: nothing is found more exactly"),                           \
        PSFM_OPTION(FIELD.noise.min_max_error_px, 1e-6, 1e5, "and least bound on errors [px]",   \
                    "ours; not tuned: large features are off by as much")
// NOLINTEND(bugprone-macro-parentheses)

// clang-format off
// to_array: clang deduces the size of no more than 256 elements.
constexpr auto kSolvingOptions = std::to_array<NamedOption>({
    PSFM_MOVED_OPTION("solve.mu_min", solve.policy.mu_min, 2, kCount, "images that a cluster needs to be reconstructed", "ours, on parts of ordinary collections; docs/notebook, three images; paper: 5"),
    PSFM_MOVED_OPTION("solve.mu_max", solve.policy.mu_max, 2, kCount, "images up to which a new cluster is started incrementally", "paper: mu_max"),
    PSFM_MOVED_OPTION("solve.eta_grow", solve.policy.full_adjustment.again_when_grown_by, 1e-6, 100, "growth after which all of a model is adjusted", "paper: eta_grow"),
    PSFM_MOVED_OPTION("solve.doubt.max_images", solve.policy.doubt_up_to, 0, 2000, "images up to which a model is compared with others at the end; 0: none is", "ours: the cost grows with the square; docs/notebook, folds at 300"),
    PSFM_OPTION(solve.policy.affordable_up_to, 1, kCount, "images up to which a model is adjusted and asked as a whole when it has grown", "ours, on towns; docs/notebook, thousands of images"),
    PSFM_OPTION(solve.policy.converge_up_to, 1, kCount, "images up to which that goes to convergence", "ours, on quad-streams; docs/notebook, thousands of images"),
    PSFM_OPTION(solve.policy.large_from, 1, kCount, "images from which new ones are added by what they can change", "ours, on quad-streams; docs/notebook, image by image"),
    PSFM_OPTION(solve.policy.new_start.again_when_grown_by, 0, 100, "growth after which a model that leaves much out is compared with a new one", "ours; not tuned"),
    PSFM_OPTION(solve.policy.places.again_when_grown_by, 0, 100, "growth after which a model of more than affordable_up_to is asked for places again", "ours; not tuned"),
    PSFM_OPTION(solve.policy.rotations.again_when_grown_by, 0, 100, "growth after which a contradiction that was kept is asked again", "ours; not tuned"),
    PSFM_OPTION(solve.policy.ties.again_when_grown_by, 0, 100, "growth after which it is asked which cameras may be one", "ours; not tuned"),

    PSFM_OPTION(solve.global.adjusted_tracks_per_image, 1, kCount, "tracks adjusted in the first rounds, seen by each image", "ours; docs/accuracy.md"),
    PSFM_ADJUSTMENT_OPTIONS(solve.global.adjustment, "COLMAP 3.8, of local adjustments", "ours: photographs take 15 to 17; not tuned further"),
    PSFM_OPTION(solve.global.calibration_images, 2, kCount, "images of a small model that tells shared intrinsics", "ours; docs/accuracy.md"),
    PSFM_OPTION(solve.global.directions.axes, 1, kCount, "axes on which positions are ordered", "Wilson & Snavely 2014"),
    PSFM_OPTION(solve.global.directions.bandwidth_deg, 0.01, 180, "standard deviation of an axis about the direction it is drawn from [deg]", "ours; not tuned"),
    PSFM_OPTION(solve.global.directions.max_score, 0, 1, "score above which a direction is dropped", "GTSfM, OUTLIER_WEIGHT_THRESHOLD"),
    PSFM_OPTION(solve.global.images_to_calibrate, 1, kCount, "images of one camera that such a model needs", "ours; not tuned"),
    PSFM_OPTION(solve.global.max_focal_change, 1, 1000, "factor by which its focal length may differ from EXIF's", "ours; not tuned"),
    PSFM_OPTION(solve.global.positions.loss_scale_deg, 0.001, 180, "residual from which a direction loses weight [deg]", "Wilson & Snavely 2014"),
    PSFM_OPTION(solve.global.positions.max_length_sigma, 1e-4, 100, "how well lengths of edges that meet are known, relative to one another", "ours, on planted lines and rings: of 30 nodes on a line up to 9 are placed, 24 with 0.3"),
    PSFM_OPTION(solve.global.positions.max_refinement_iterations, 1, 1e6, "iterations of the refinement", "ours; not tuned"),
    PSFM_OPTION(solve.global.positions.max_start_iterations, 1, kCount, "steps of the convex start", "ours: planted cases take 10 to 40"),
    PSFM_OPTION(solve.global.positions.min_noise_deg, 1e-6, 90, "noise of a direction at least [deg]", "ours; not tuned"),
    PSFM_OPTION(solve.global.positions.start_convergence, 0, 1, "a step that lowers the cost by a smaller part is the last", "ours; not tuned"),
    PSFM_OPTION(solve.global.rotation_refinements, 0, kCount, "linearisations that refine the averaged rotations", "ours; not tuned"),
    PSFM_OPTION(solve.global.round_tolerance, 1e-12, 1, "function_tolerance of the rounds before the last", "ours; not tuned"),
    PSFM_OPTION(solve.global.start_error_px, 0.01, 1e5, "error of an observation in the first round [px]", "ours; not tuned"),
    PSFM_OPTION(solve.global.track_weight, 1e-6, 1000, "weight of a direction to a point; of one to an image: 1", "ours, on temple-341; docs/accuracy.md, \"Global reconstruction\""),
    PSFM_OPTION(solve.global.tracks_per_image, 0, kCount, "tracks that join the images as nodes, seen by each; 0: none", "ours, on temple-341; docs/accuracy.md, \"Global reconstruction\""),

    PSFM_OPTION(solve.few_points.min_inlier_ratio, 0.001, 1, "part of the points that have to agree with the pose", "ours; not tuned"),
    PSFM_OPTION(solve.few_points.min_observations, 0, kCount, "observations that confirm it", "ours; not tuned"),
    PSFM_OPTION(solve.few_points.min_points, 0, kCount, "points that an image needs which no model sees enough of; 0: as any", "ours, on kitchen: an image of 14 points and 398 matches; judged on the other collections"),
    PSFM_OPTION(solve.images_around_joint, 0, kCount, "images of a large model that are adjusted around a joint", "ours; not tuned"),
    PSFM_OPTION(solve.images_to_hand_on, 1, kCount, "images of a camera whose intrinsics other clusters take over", "ours; not tuned"),
    PSFM_OPTION(solve.join_again_after, 1, 1000000.0, "images after which models without a joint are tried again, then twice as many", "ours; not tuned"),
    PSFM_OPTION(solve.lenses.max_focal_change, 0, 1, "part by which a focal length may change in any case with a second radial coefficient", "ours, on brighton; docs/accuracy.md"),
    PSFM_OPTION(solve.lenses.min_focal_curvature, 0, 1e6, "by more where the error grows by so many times that part's square with it held", "ours, on brighton; docs/notebook/2026-11-26-second-coefficient.md"),
    PSFM_OPTION(solve.lenses.min_gain, 0, 1, "part of the RMS error that has to go with it", "ours; docs/accuracy.md"),
    PSFM_OPTION(solve.lenses.min_images, 0, kCount, "images that share a camera for it to get one; 0: none does", "ours, on multicam; docs/accuracy.md"),
    PSFM_OPTION(solve.lenses.points_per_image, 1, kCount, "points seen by each image that are adjusted to find that out", "ours; not tuned"),
    PSFM_OPTION(solve.lenses.tolerance, 0, 1, "function_tolerance of these adjustments, at least", "ours; not tuned"),
    PSFM_OPTION(solve.local_longest_track, 0, kCount, "points that more images see stand still in local adjustments; 0: all move", "COLMAP 3.8"),
    PSFM_OPTION(solve.local_neighbors, 0, kCount, "images beside a new one whose poses move with it", "COLMAP 3.8: 6 in all"),
    PSFM_OPTION(solve.max_contradicting_edges, 0, 1, "part of the edges that may contradict a model that is kept", "ours; not tuned"),
    PSFM_OPTION(solve.max_contradiction_deg, 0, 180, "rotations that differ by more contradict a model [deg]", "paper: rho_l,max"),
    PSFM_OPTION(solve.max_edge_error_deg, 1e-6, 180, "edges that differ by more from averaged rotations are left out [deg]", "paper: rho_g,max"),
    PSFM_OPTION(solve.max_region, 0, 1, "part of a model above which all of it is adjusted instead of a region", "ours; not tuned"),
    PSFM_OPTION(solve.max_reset_images, 0, 1, "part of a model that is placed anew instead of all of it", "ours; not tuned; paper: 0"),
    PSFM_OPTION(solve.max_surroundings, 0, 1, "part of a model's points up to which its surroundings are solved by themselves", "ours; not tuned"),
    PSFM_OPTION(solve.min_observations, 1, kCount, "observations that keep an image in its model", "ours; not tuned: half of what registration asks"),
    PSFM_OPTION(solve.neighbor_points, 1, kCount, "points that images share which are adjusted together", "ours; not tuned: about what a pose needs"),
    PSFM_OPTION(solve.reset.enough, 0, 1, "part of a cluster that a start must hold for no other one to be made", "ours; not tuned"),
    PSFM_OPTION(solve.reset.max_left, 0, 1, "part of the contradicting edges that may be left in a model taken apart and joined again", "ours; not tuned"),
    PSFM_OPTION(solve.reset.max_lost, 0, 1, "part of its images that it may lose by that", "ours; not tuned"),
    PSFM_OPTION(solve.reset.min_kept, 0, 1, "part of the old model's images, and observations, that a better one must have", "ours; not tuned"),
    PSFM_OPTION(solve.reset.stuck_below, 0, 1, "part of its cluster that a model must hold for no new start to be tried", "ours; not tuned"),
    PSFM_OPTION(solve.reset.worse_by, 1, 1000, "times that a contradiction must have grown to be looked into again", "ours; not tuned"),
    PSFM_OPTION(solve.strong_lenses.max_bend_deg, 0, 180, "pairs whose rotation differs by less from the model's are not seen through them again [deg]", "ours; docs/notebook/2026-11-29-strong-lenses.md"),
    PSFM_OPTION(solve.strong_lenses.min_displacement, 0, 1, "part of the longer side by which a lens moves corners for its pairs to be seen through it; 0: none", "ours; docs/cameras.md"),
    PSFM_OPTION(solve.weak_edge_weight, 1e-09, 1, "what a weak edge weighs in rotation averaging", "ours; not tuned: it decides where nothing else does"),

    PSFM_OPTION(solve.places.between.companions, 0, kCount, "images that are asked with one for what is seen from both sides of it", "ours, on parts of street, books and cereal; docs/notebook, seen from both sides"),
    PSFM_OPTION(solve.places.between.size_slack, 0, 0.99, "part by which a point is larger or smaller than in all that see it", "ours; not tuned"),
    PSFM_OPTION(solve.places.between.grid, 1, 64, "cells along the longer side of a photograph", "ours; not tuned"),
    PSFM_OPTION(solve.places.between.margin, 0, 0.49, "rim of a photograph in which no point is expected, over its longer side", "ours; not tuned"),
    PSFM_OPTION(solve.places.between.max_angle_deg, 0.01, 89, "directions from which a point is found again [deg]", "ours, on parts of street, books and cereal; docs/notebook, seen from both sides"),
    PSFM_OPTION(solve.places.between.max_neighbors, 1, kCount, "images whose points are looked at", "ours; not tuned"),
    PSFM_OPTION(solve.places.between.max_offset, 1e-6, 100, "their distance, over the depth of what is seen", "ours; not tuned"),
    PSFM_OPTION(solve.places.between.max_spread_deg, 0.001, 179, "angle between two who see a point from both sides, at most [deg]", "ours; not tuned"),
    PSFM_OPTION(solve.places.between.max_track, 2, kCount, "images of a track that are asked", "ours; not tuned"),
    PSFM_OPTION(solve.places.between.min_asked, 1, kCount, "images that have to see a point before it counts", "ours; not tuned"),
    PSFM_OPTION(solve.places.between.min_depth, 0, 1, "depth of what stands in front of a point, over its own", "as solve.doubt.min_depth"),
    PSFM_OPTION(solve.places.between.min_own, 0, kCount, "points around a point that is in sight", "as solve.doubt.min_own"),
    PSFM_OPTION(solve.places.between.min_spread_deg, 0, 178, "angle between two who see a point from both sides, at least [deg]", "ours; not tuned"),
    PSFM_OPTION(solve.places.between.min_track, 2, kCount, "images that have seen a point before others are expected to", "ours; not tuned"),
    PSFM_OPTION(solve.places.between.slack_deg, 0, 90, "angles to both that are more than the one between them [deg]", "ours; not tuned"),
    PSFM_OPTION(solve.places.between_points, 1, kCount, "points of each image of which it is asked what is seen from both sides", "ours; not tuned"),
    PSFM_OPTION(solve.places.edge_weight, 0, 100, "what an edge says for one place, where a pair side by side says up to 1", "ours; not tuned"),
    PSFM_OPTION(solve.places.clear_part, 0, 1, "part of a few points from which a pair is of one place", "ours; not tuned"),
    PSFM_OPTION(solve.places.folded_between, 0, 1, "part of what is seen from both sides that two places share, over the model's", "ours, on a town of 300 and quad-streams; docs/notebook, seen from both sides"),
    PSFM_OPTION(solve.places.full_between, 1, kCount, "such points with which a pair says all that it can", "ours; not tuned"),
    PSFM_OPTION(solve.places.glance_factor, 1, 1000, "times max_shared_by_chance that a pair shares of a few points at most where it shares nothing", "ours; not tuned"),
    PSFM_OPTION(solve.places.glance_points, 1, kCount, "points of each image that are looked at first", "ours; docs/look-alikes.md, \"Places\""),
    PSFM_OPTION(solve.places.left_out, 0, 1, "whether images that a model leaves out make one of their own once no more images come (1), or wait (0)", "ours; docs/look-alikes.md, \"Places\""),
    PSFM_OPTION(solve.places.margin, 0, 0.49, "rim of a photograph in which no point is expected, over its longer side", "ours; not tuned"),
    PSFM_OPTION(solve.places.max_neighbors, 1, kCount, "images beside it with which an image is compared", "ours; not tuned"),
    PSFM_OPTION(solve.places.max_offset, 1e-6, 100, "distance of images side by side, over the depth of what they see", "ours; docs/look-alikes.md, \"Places\""),
    PSFM_OPTION(solve.places.max_shared_by_chance, 0, 1, "part of the expected points up to which a pair shares nothing", "ours; docs/look-alikes.md, \"Places\""),
    PSFM_OPTION(solve.places.max_turn_deg, 1e-6, 180, "and their turn [deg]", "ours; docs/look-alikes.md, \"Places\""),
    PSFM_OPTION(solve.places.min_between, 1, kCount, "such points between two places", "ours; not tuned"),
    PSFM_OPTION(solve.places.min_contradictions, 0, kCount, "pairs side by side that share nothing between two places; 0: a model is never asked", "ours; docs/look-alikes.md, \"Places\""),
    PSFM_OPTION(solve.places.min_expected, 1, kCount, "points that two images are expected to share before they are compared", "ours; not tuned"),
    PSFM_OPTION(solve.places.min_images, 1, kCount, "images of a place", "ours, on quad-streams: two of 435 images were taken for a place"),
    PSFM_OPTION(solve.places.min_track, 2, kCount, "images that have seen a point before others are expected to", "ours; not tuned"),
    PSFM_OPTION(solve.places.min_within, 0, 1000, "such points within the smaller of two places, for each one between them", "ours, on quad-streams, street and cereal; docs/notebook, parted from a right model"),
    PSFM_OPTION(solve.places.reached_rank, 1, kCount, "rank of the pair whose share counts for what an image reaches", "ours; not tuned: one may be nearly a copy"),
    PSFM_OPTION(solve.places.same_between, 0.001, 0.999, "part of what is seen from both sides that speaks for one place, over the model's", "ours, on a town of 300 and quad-streams; docs/notebook, seen from both sides"),
    PSFM_OPTION(solve.places.same_place, 0.001, 0.999, "part of the expected points that speaks for one place", "ours, on the simulated town and Strecha's scenes; docs/look-alikes.md, \"Places\""),

    PSFM_OPTION(solve.loops.edges_per_image, 1, kCount, "edges that hold an image in place when a loop is closed", "ours, on the simulated town; docs/notebook, loops"),
    PSFM_OPTION(solve.loops.drift_loss_scale, 1e-06, 1000, "Huber scale of the pose graph that spreads drift", "ours; not tuned: hardly a residual is an outlier"),
    PSFM_OPTION(solve.loops.images_per_group, 1, kCount, "images that move as one where nothing is strained", "ours; not tuned"),
    PSFM_OPTION(solve.loops.max_iterations, 1, kCount, "steps of its pose graph", "ours, on the simulated town; docs/notebook, loops"),
    PSFM_OPTION(solve.loops.max_lost_observations, 0, 1, "part of the observations that closing may cost", "ours, on the simulated town; not tuned further"),
    PSFM_OPTION(solve.loops.max_residual, 1e-6, 1000, "residual from which an edge is still open, or torn", "ours, on the simulated town; not tuned further"),
    PSFM_OPTION(solve.loops.max_shared_part, 0, 1, "part of an open edge's matches that have a point in common", "ours, on the simulated town; not tuned further"),
    PSFM_OPTION(solve.loops.max_torn, 0, 1000, "edges that closing tears, over those that it closes", "ours, on the simulated town; not tuned further"),
    PSFM_OPTION(solve.loops.min_gap, 0, 1000, "distance of the two points of a match, over their depth", "ours, on the simulated town; docs/notebook, loops"),
    PSFM_OPTION(solve.loops.min_matches, 1, kCount, "matches between points before an edge says anything", "ours, on the simulated town; not tuned further"),
    PSFM_OPTION(solve.loops.min_open_edges, 0, kCount, "open edges that a large model has before a loop is closed; 0: none is", "ours, on the simulated town; docs/accuracy.md, \"Loops\"; paper: 0"),
    PSFM_OPTION(solve.loops.min_strain, 1e-09, 1000, "residual from which an edge that holds has been strained", "ours; not tuned: some pixels; docs/notebook, loops"),

    PSFM_OPTION(solve.doubt.as_well_explained, 0, 1, "factor of observations from which a model without a doubt replaces a doubted one", "ours, on street, books and cereal; docs/notebook, rival models"),
    PSFM_OPTION(solve.doubt.folded, 0, 1, "part of what is seen from both sides that is shared across a fold, over the same elsewhere", "ours; docs/look-alikes.md, \"Seen from both sides\""),
    PSFM_OPTION(solve.doubt.grid, 1, 64, "regions along each side of a photograph", "ours; not tuned"),
    PSFM_OPTION(solve.doubt.clearly_less, 0, 1, "part of what is missing from one model that is missing from a better one", "ours; not tuned"),
    PSFM_OPTION(solve.doubt.contested, 0, 1000, "what a model denies across a cut, over what it explains there, from which it is doubtful", "ours; docs/look-alikes.md, \"Missing regions\""),
    PSFM_OPTION(solve.doubt.companions, 0, kCount, "images that stand about one, and see nothing of a missing region either", "ours, on parts of street, books and cereal; docs/notebook, seen from both sides"),
    PSFM_OPTION(solve.doubt.few_shared, 0, kCount, "points below which a pair shares next to nothing", "verification.verify.min_inliers"),
    PSFM_OPTION(solve.doubt.min_contest, 0, 1000, "a cut that holds is tried where the model denies so much, over what it explains", "ours; docs/look-alikes.md, \"Missing regions\""),
    PSFM_OPTION(solve.doubt.held, 0, 1, "and from which the parts are one thing", "ours; docs/look-alikes.md, \"Seen from both sides\""),
    PSFM_OPTION(solve.doubt.less_explained, 0, 1, "part of the observations that a model has where less is missing", "ours; not tuned"),
    PSFM_OPTION(solve.doubt.max_angle_deg, 0.01, 89, "directions from which a point is found again [deg]", "ours, on parts of street, books and cereal; docs/notebook, seen from both sides"),
    PSFM_OPTION(solve.doubt.max_cuts, 0, 1000, "cuts of a doubted model that are tried", "ours; not tuned"),
    PSFM_OPTION(solve.doubt.max_denied, 0, 1, "part of an edge's matches below which a model denies it", "ours: right edges of models of hardly any depth keep a tenth; not tuned further"),
    PSFM_OPTION(solve.doubt.max_rounds, 0, 1000, "how often the best one is cut again", "ours; not tuned"),
    PSFM_OPTION(solve.doubt.max_scale, 1, 1000, "ratio of sizes at which a point is found again", "ours; not tuned"),
    PSFM_OPTION(solve.doubt.min_denied, 0, 1, "matches of an edge that is not to be denied, over those of its images' best", "ours, on street and books; docs/notebook, missing regions"),
    PSFM_OPTION(solve.doubt.min_between, 1, kCount, "points that are expected across a fold", "ours; not tuned"),
    PSFM_OPTION(solve.doubt.min_depth, 0, 1, "depth of what an image sees itself in a missing region, over the expected", "ours, on books and temple-341; docs/notebook, missing regions"),
    PSFM_OPTION(solve.doubt.min_expected, 0.001, 1e6, "matches expected in a region that is missing", "ours; not tuned"),
    PSFM_OPTION(solve.doubt.min_explained, 0, 1, "part of an edge's matches from which a model explains it", "ours: right edges keep half and more; not tuned further"),
    PSFM_OPTION(solve.doubt.min_missing, 1, kCount, "regions that are missing where a pair contradicts its model", "ours; not tuned"),
    PSFM_OPTION(solve.doubt.min_missing_part, 0.01, 1, "part of a pair's regions that are missing where it contradicts its model", "ours; not tuned"),
    PSFM_OPTION(solve.doubt.min_own, 0, kCount, "points of its own that an image sees in a missing region", "ours; not tuned"),
    PSFM_OPTION(solve.doubt.min_points, 1, kCount, "points expected of a pair that is compared", "ours; not tuned"),
    PSFM_OPTION(solve.doubt.min_rivalry, 0, 1000, "squares of relative matches that each of two rivals explains and the other denies", "ours; not tuned"),
    PSFM_OPTION(solve.doubt.min_split_pairs, 1, kCount, "pairs that contradict each other across two parts that are kept apart", "ours; not tuned"),
    PSFM_OPTION(solve.doubt.min_split_part, 0.001, 1, "and the part of the regions that are missing across", "ours, on cereal and quad-streams; docs/notebook, few photographs of a large place"),
    PSFM_OPTION(solve.doubt.min_track, 2, kCount, "images that have seen a point that is expected", "ours; not tuned"),
    PSFM_OPTION(solve.doubt.missing_by_chance, 0, kCount, "regions that are missing from one of two models by chance", "ours; not tuned"),
    PSFM_OPTION(solve.doubt.missing_penalty, 0, 10000.0, "how fast an edge loses weight with the part of regions missing across it", "ours; not tuned"),
    PSFM_OPTION(solve.doubt.more_explained, 1, 1000, "factor of observations by which a better model explains more", "ours; not tuned"),
    PSFM_OPTION(solve.doubt.outweighed, 0, 1000, "and from which its parts are kept apart, where they hang together by little", "ours, on parts of street, books and cereal; docs/notebook, thin joints"),
    PSFM_OPTION(solve.doubt.thin, 0, 1000, "which is less than this: squares of matches over those of the best edges", "ours, on parts of street, books and cereal; docs/notebook, thin joints"),
    PSFM_OPTION(solve.doubt.unknown_rate, 0.001, 1, "rate of points found again where a pair shares next to nothing", "ours; not tuned: about that of a verified pair"),

    PSFM_OPTION(solve.assessment.joint_points, 0, kCount, "points by which two parts of a model hang together", "ours; not tuned"),
    PSFM_OPTION(solve.assessment.max_focal_factor, 1, 1000, "focal lengths of one size of photographs, over their median", "ours; not tuned"),
    PSFM_OPTION(solve.assessment.max_invented, 0, 1, "part of known turns that a model may show as steps; 0: all", "ours, on datasets/cases; not tuned further; paper: 0"),
    PSFM_OPTION(solve.assessment.max_relative_focal, 0.01, 1000, "focal length at most, over the longer side", "ours; not tuned: views of 10 degrees"),
    PSFM_OPTION(solve.assessment.max_turn_parallax_deg, 0.001, 180, "directions to a point that contradict a turn [deg]", "ours, on datasets/cases: matches of a turn are within 0.3 at a focal length of 1,000 px"),
    PSFM_OPTION(solve.assessment.max_turn_stretch, 0, 1000, "stretch of a homography that is a turn", "ours; not tuned"),
    PSFM_OPTION(solve.assessment.min_relative_focal, 0.001, 1000, "focal length at least", "ours; not tuned: views of 120 degrees"),
    PSFM_OPTION(solve.assessment.min_turn_deg, 0, 180, "turns by less say nothing [deg]", "ours, on datasets/cases; not tuned further"),
    PSFM_OPTION(solve.assessment.min_turns, 0, 1, "part of a model's edges that are turns before it is asked", "ours, on datasets/cases; not tuned further"),
    PSFM_OPTION(solve.assessment.weak_angle_deg, 0, 180, "median angle to a point below which a model is weak [deg]", "ours; not tuned: twice COLMAP's least"),
    PSFM_OPTION(solve.assessment.weak_points, 0, kCount, "points of an image, at the median, below which it is", "ours; not tuned"),

    PSFM_OPTION(solve.ties.excused_px, 0, 1000, "error that no camera is blamed for [px]", "ours, on noexif-nadir; docs/notebook, noise"),
    PSFM_OPTION(solve.ties.max_iterations, 1, 1e6, "iterations of the adjustments that this takes", "ours; not tuned"),
    PSFM_OPTION(solve.ties.max_step, 1e-6, 10, "gap of focal lengths at which cameras are parted", "ours: a photograph tells its focal length to some per cent; docs/verification.md"),
    PSFM_OPTION(solve.ties.max_zooms, 1, 100, "zooms that may explain cameras of which some differ; 1: not asked", "ours, on brighton and ioniq5 with every third zoomed; docs/notebook, few zooms"),
    PSFM_OPTION(solve.ties.min_deviation, 1e-6, 10, "part by which a focal length differs that is another one", "ours; not tuned: focus moves focal lengths by one or two per cent"),
    PSFM_OPTION(solve.ties.min_gain, 1, 1000, "factor by which a camera of its own lowers an image's error", "ours; not tuned"),
    PSFM_OPTION(solve.ties.min_observations, 1, kCount, "observations that say something of a camera", "ours; not tuned"),
    PSFM_OPTION(solve.ties.min_zoom_gain, 1, 1000, "factor by which a rarer zoom lowers the cost of what an image sees", "ours, on brighton and ioniq5 with every third zoomed; docs/notebook, few zooms"),
    PSFM_OPTION(solve.ties.points_per_image, 1, kCount, "points that are looked at, seen by each image", "ours; not tuned"),
    PSFM_OPTION(solve.ties.second_coefficient, 0, 1, "whether cameras are one where two radial coefficients explain them all, though one does not (1)", "ours, on brighton with a barrel distortion; docs/notebook, other sizes and lenses"),

    PSFM_OPTION(solve.initialization.max_pairs, 1, kCount, "pairs tried for one start", "ours; not tuned"),
    PSFM_OPTION(solve.initialization.max_starts, 1, 1000, "starts of one solve while no model has half of the cluster", "ours; not tuned"),
    PSFM_OPTION(solve.initialization.min_angle_deg, 0, 180, "median triangulation angle of a start [deg]", "COLMAP 3.8"),
    PSFM_OPTION(solve.initialization.min_points, 5, kCount, "points of a start", "ours; not tuned; COLMAP 3.8: 100"),
    PSFM_OPTION(solve.absolute_pose.max_error_px, 0.01, 1000, "reprojection error of an inlier of a registration [px]", "COLMAP 3.8, abs_pose_max_error"),
    PSFM_OPTION(solve.absolute_pose.max_iterations, 1, 1e8, "RANSAC iterations of a registration", "COLMAP 3.8"),
    PSFM_OPTION(solve.absolute_pose.min_inlier_ratio, 0, 1, "share of the points that a registration needs", "COLMAP 3.8, abs_pose_min_inlier_ratio"),
    PSFM_OPTION(solve.absolute_pose.min_inliers, 4, kCount, "inliers that a registration needs", "ours; not tuned; COLMAP 3.8: 30"),
    PSFM_OPTION(solve.tracks.completion_depth, 0, 1000, "steps along matches when a track is completed", "COLMAP 3.8"),
    PSFM_OPTION(solve.tracks.max_error_px, 0.01, 1000, "largest reprojection error of an observation [px]", "COLMAP 3.8, filter_max_reproj_error"),
    PSFM_OPTION(solve.tracks.min_angle_deg, 0, 180, "least triangulation angle of a point [deg]", "COLMAP 3.8, filter_min_tri_angle"),
    PSFM_ADJUSTMENT_OPTIONS(solve.local_adjustment, "COLMAP 3.8", "COLMAP 3.8"),
    PSFM_REFINEMENT_OPTIONS(solve.growth, "COLMAP 3.8, of local adjustments"),
    PSFM_REFINEMENT_OPTIONS(solve.large_growth, "ours, on quad-streams; docs/notebook, thousands of images"),
    PSFM_REFINEMENT_OPTIONS(solve.settling, "COLMAP 3.8"),

    PSFM_OPTION(solve.rotation_averaging.consensus_deg, 0, 180, "parts join where edges agree within so many degrees; 0: along the maximum spanning tree", "ours; docs/look-alikes.md, \"Rotations\"; paper: 0"),
    PSFM_OPTION(solve.rotation_averaging.convergence_deg, 0, 180, "change of a rotation that ends it [deg]", "ours; not tuned"),
    PSFM_OPTION(solve.rotation_averaging.loss, 0, 3, "loss of the refinement: l_1/2 (0), Huber (1), Cauchy (2), Geman-McClure (3)", "ours; docs/look-alikes.md, \"Rotations\""),
    PSFM_OPTION(solve.rotation_averaging.loss_scale_deg, 0.001, 180, "residual from which an edge loses weight [deg]", "Chatterjee & Govindu 2018"),
    PSFM_OPTION(solve.rotation_averaging.max_iterations, 0, kCount, "linearisations of the L1 optimum", "ours; docs/look-alikes.md, \"Rotations\"; paper: to convergence"),
    PSFM_OPTION(solve.rotation_averaging.max_solver_iterations, 1, kCount, "steps of one linearisation", "ours; not tuned"),
    PSFM_OPTION(solve.rotation_averaging.norm, 0, 1, "L1 norm of a residual: its length (0), its coordinates (1)", "ours: does not depend on the frame's axes; docs/design.md; Chatterjee & Govindu 2013: 1"),
    PSFM_OPTION(solve.rotation_averaging.refine_iterations, 0, kCount, "linearisations of reweighted least squares after that", "ours; docs/look-alikes.md, \"Rotations\"; paper: 0"),
    PSFM_OPTION(solve.rotation_averaging.strongest_edges_per_node, 0, kCount, "edges of an image that pull at the rotations; 0: all", "paper"),
    PSFM_OPTION(solve.rotation_averaging.turn_again_factor, 0, 1e9, "parts are turned again where so many times more speaks for it, beyond one edge; 0: never", "ours, on ioniq5 at 800 px; docs/look-alikes.md; paper: 0"),
    PSFM_OPTION(solve.rotation_averaging.vote_power, 0, 10, "power of an edge's weight with which it votes where parts are joined", "ours, on a simulated temple and quad-streams; docs/look-alikes.md, \"Rotations\""),
    PSFM_OPTION(solve.rotation_averaging.weight_power, 0, 10, "power of an edge's weight with which it counts", "paper"),
    NamedOption{"solve.plausibility", "edges count with their plausibility, too, when rotations are averaged (0, 1)", "ours; docs/look-alikes.md, \"Rotations\"; paper: 0", 0, 1,
        [](const StageOptions& options) { return options.solve.plausibility ? 1.0 : 0.0; },
        [](StageOptions& options, double value) {
            if (value == 0.0) options.solve.plausibility.reset();
            else if (!options.solve.plausibility) options.solve.plausibility.emplace();
        }},

    PSFM_OPTION(solve.focal_calibration.loss_px, 0.001, 1000, "scale of the loss on pairs' errors when focal lengths are found [px]", "ours, on Strecha's scenes; docs/verification.md"),
    PSFM_OPTION(solve.focal_calibration.expected_deviation, 1e-06, 100, "deviation of the common focal length's logarithm from the expected one", "ours; not tuned"),
    PSFM_OPTION(solve.focal_calibration.expected_relative_focal, 0.01, 1000, "focal length that is expected, over the longer side", "COLMAP 3.8, default_focal_length_factor"),
    PSFM_OPTION(solve.focal_calibration.max_iterations, 1, 1e6, "steps of the joint refinement", "ours; not tuned: most scenes need ten"),
    PSFM_OPTION(solve.focal_calibration.max_pair_points, 1, kCount, "correspondences taken of a pair", "ours, on Strecha's scenes; docs/verification.md"),
    PSFM_OPTION(solve.focal_calibration.max_pairs, 1, kCount, "pairs taken", "ours; not tuned"),
    PSFM_OPTION(solve.focal_calibration.max_relative_focal, 0.1, 1000, "focal lengths tried, over the longer side", "ours; not tuned: views of 14 degrees"),
    PSFM_OPTION(solve.focal_calibration.max_uncertainty, 0, 100, "relative uncertainty above which a camera keeps its guess", "ours; not tuned"),
    PSFM_OPTION(solve.focal_calibration.min_pair_inliers, 1, kCount, "inliers of a pair that counts", "ours; not tuned: twice COLMAP's min_num_inliers"),
    PSFM_OPTION(solve.focal_calibration.min_relative_focal, 0.01, 1000, "and at least", "ours; not tuned: views of 118 degrees"),
    PSFM_OPTION(solve.focal_calibration.pair_loss, 1e-6, 1000, "mean cost at which a pair weighs a quarter", "ours, on Strecha's scenes; docs/verification.md"),
    PSFM_OPTION(solve.focal_calibration.spread, 1e-6, 100, "deviation expected between cameras of one size", "ours, on Strecha's scenes; docs/verification.md"),
    PSFM_OPTION(solve.focal_calibration.vote_width, 1e-6, 100, "width of a pair's vote", "ours, on Strecha's scenes; docs/verification.md"),
    PSFM_OPTION(solve.focal_calibration.wide_angle_deg, 0.1, 180, "triangulation angle above which a wider one tells no more [deg]", "ours; not tuned"),

    PSFM_OPTION(solve.verification.confidence, 0, 1, "as verification.verify, of pairs whose focal lengths became known later", "COLMAP 3.8"),
    PSFM_OPTION(solve.verification.max_error_px, 0.01, 1000, "likewise [px]", "ours, on Strecha's scenes; docs/verification.md"),
    PSFM_OPTION(solve.verification.max_iterations, 1, 1e8, "likewise", "ours; docs/verification.md"),
    PSFM_OPTION(solve.verification.min_inlier_ratio, 0, 1, "likewise", "ours, on Strecha's scenes and kitchen; docs/verification.md"),
    PSFM_OPTION(solve.verification.min_inliers, 8, 1e6, "likewise", "COLMAP 3.8, min_num_inliers"),
    PSFM_OPTION(solve.verification.refine_loss_px, 0.001, 1000, "likewise [px]", "ours; docs/verification.md"),
});
// clang-format on
#undef PSFM_ADJUSTMENT_OPTIONS
#undef PSFM_REFINEMENT_OPTIONS

}  // namespace

std::span<const NamedOption> options_of_solving() {
    return kSolvingOptions;
}

}  // namespace psfm
