// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "graph/result.h"
#include "stages/algorithms/adjustment/adjustment_options.h"
#include "stages/algorithms/alignment/alignment_options.h"
#include "stages/algorithms/averaging/average_positions.h"
#include "stages/algorithms/averaging/average_rotations.h"
#include "stages/algorithms/averaging/filter_directions.h"
#include "stages/algorithms/focal/calibrate_focals.h"
#include "stages/algorithms/pose/absolute_pose.h"
#include "stages/clustering/plausibility.h"
#include "stages/reconstruction/model/assessment_options.h"
#include "stages/reconstruction/model/doubt_options.h"
#include "stages/reconstruction/model/estimate_point.h"
#include "stages/reconstruction/model/loop_options.h"
#include "stages/reconstruction/model/place_options.h"
#include "stages/reconstruction/model/solve_policy.h"
#include "stages/reconstruction/model/tie_options.h"
#include "stages/verification/verify_options.h"

namespace psfm {

/// Starting a model from two views.
struct InitializationOptions {
    /// Points that the two-view model must have. Lower: starts from weaker pairs. COLMAP 3.8's
    /// init_min_num_inliers is 100; ours, not tuned, since mu_min images with few matches must
    /// still make a model.
    std::uint32_t min_points = 50;
    /// Median triangulation angle at least [deg]; halved three times when no pair has it.
    /// COLMAP 3.8: 16.
    double min_angle_deg = 16.0;
    /// Pairs tried at most for one start. Ours; not tuned.
    std::uint32_t max_pairs = 30;
    /// Starts of one solve, each from other images, while no model has half of the cluster. Raised:
    /// slower where no model has; lowered: a start in the wrong place decides. Not tuned.
    std::uint32_t max_starts = 3;
};

/// When a camera gets a second radial coefficient (judge_lenses.h). All ours; figures:
/// docs/accuracy.md.
struct LensOptions {
    /// Images that have to share it; 0: no camera gets one, as in the paper. Lowered: few images
    /// are explained by whatever is free.
    std::uint32_t min_images = 10;
    /// Part of the RMS error that goes with it. Lowered: cameras get coefficients that say nothing;
    /// raised: lenses stay bent.
    double min_gain = 0.01;
    /// Part by which the focal length may change in any case. Raised: scenes that do not determine
    /// it end with a wrong one.
    double max_focal_change = 0.015;
    /// It may change by more where the scene determines it: held where it was, the RMS error grows
    /// by so many times the square of that part. Flights over flat land have 0.2 and 0.7, walks
    /// and rings 19 to 215. Raised: what one coefficient has bent stays so.
    double min_focal_curvature = 4.0;
    /// Points that are adjusted to find that out, about so many seen by each image.
    std::uint32_t points_per_image = 400;
    /// function_tolerance of these adjustments, at least.
    double tolerance = 1e-5;
};

/// Adjusting all of a model.
struct RefinementOptions {
    AdjustmentOptions adjustment{
        .loss_scale_px = 1.0, .max_iterations = 50, .function_tolerance = 1e-6};
    /// Rounds of completing tracks, adjusting and filtering at most. COLMAP 3.8: 5.
    int max_rounds = 5;
    /// A round by which fewer of the observations came or went is the last. COLMAP 3.8: 0.0005; it
    /// counts those, too, that come and go again in every round.
    double max_change = 0.0005;
    /// function_tolerance of the rounds before the last, where it is larger: they only find out
    /// which observations to keep. Raised: faster, and the last round has more to do; 0: all rounds
    /// alike, as in COLMAP. Ours (docs/accuracy.md).
    double round_tolerance = 0.0;
    /// Images that must share a camera for its principal point to be adjusted; 0: never. Fewer:
    /// weak geometry moves it. COLMAP 3.8 never adjusts it by default; ours: on Strecha's scenes
    /// with unknown intrinsics it divides the error by two to three (docs/accuracy.md).
    std::uint32_t images_for_principal_point = 0;
    /// Points that are adjusted together with the cameras, about so many seen by each image; the
    /// others follow the cameras by themselves. 0: all. Lowered: faster, less memory, less
    /// accurate. Ours (docs/accuracy.md).
    std::uint32_t points_per_image = 0;
    /// Images from which points are thinned so. Lowered: growing takes less time, a run of books
    /// 7 % less with 8 instead of 20, and mean errors that differ by 0.1 %
    /// (docs/notebook/2026-11-30-what-an-adjustment-takes.md); settled models of common size keep
    /// all they have.
    std::uint32_t thin_from_images = 8;
    /// How far observations may be off. None: by `adjustment` and SolveOptions::tracks alone.
    NoiseBounds noise = {};
};

/// Starting a model with all images at once.
struct GlobalOptions {
    /// Images of a small model that tells the intrinsics of shared cameras beforehand.
    /// Raised: slower; lowered: intrinsics less well determined. Ours (docs/accuracy.md,
    /// "Intrinsics first").
    std::uint32_t calibration_images = 20;
    /// Images of one camera that such a model must have. Lowered: cameras are taken for calibrated
    /// that are not; raised: cameras of few images are not. Ours; not tuned.
    std::uint32_t images_to_calibrate = 6;
    /// Factor by which its focal length may differ from what EXIF says. Raised: small models that
    /// went wrong are believed; lowered: EXIF that is wrong is. Not tuned.
    double max_focal_change = 1.25;
    /// Linearisations of reweighted least squares that refine the averaged rotations. Lowered:
    /// rotations, and with them directions, less accurate. Ours; not tuned.
    std::uint32_t rotation_refinements = 20;
    /// Feature tracks that join the images as nodes, about so many seen by each image; 0: none.
    /// Raised: slower; lowered: less accurate, and without any, cameras on a line are not placed.
    /// Wilson & Snavely 2014 use such a cover; the number is ours, tuned on the temple
    /// (docs/accuracy.md).
    std::uint32_t tracks_per_image = 100;
    /// Weight of a direction from an image to a point; that of a pair is 1. Raised: wrong matches
    /// pull more; lowered: wrong pairs do. Ours: 0.03 to 1 give the same on the temple
    /// (docs/accuracy.md).
    double track_weight = 0.1;
    DirectionFilterOptions directions;
    PositionAveragingOptions positions;
    /// Reprojection error of an observation at most in the first round [px], halved in each of the
    /// next down to that of `tracks`. Lowered: rough positions find no structure; raised: more
    /// rounds, and wrong matches in the first ones. Ours; not tuned.
    double start_error_px = 32.0;
    /// Tracks that are adjusted in these rounds, about so many seen by each image; then all are.
    /// Raised: slower; lowered: intrinsics less well determined. Ours (docs/accuracy.md, "A cover
    /// of 200 tracks").
    std::uint32_t adjusted_tracks_per_image = 200;
    /// Of the last of these rounds. Much is wrong at first: intrinsics, and with them rotations,
    /// along directions in which the error hardly changes. Iterations: photographs take 15 to 17;
    /// what would take more is a town that bends, for settling to undo. Ours; not tuned further.
    AdjustmentOptions adjustment{
        .loss_scale_px = 1.0, .max_iterations = 30, .function_tolerance = 1e-6};
    /// function_tolerance of those before it, which only find out which observations to keep.
    /// Lowered: slower. Ours; not tuned.
    double round_tolerance = 1e-4;
};

/// @errors kInvalidArgument
Result<void> validate(const GlobalOptions& options);

/// Registering an image that sees few points of a model, when no other can be registered: it may
/// share many features with the last image of a model, and these are no points before it is placed.
struct FewPointsOptions {
    /// Points that the pose needs; 0: as many as any registration. Raised: chains of photographs
    /// break where each sees little but its neighbours; lowered: poses are guessed.
    /// Ours, tuned on kitchen (14 points, 398 matches with one image), judged on the other
    /// collections.
    std::uint32_t min_points = 10;
    /// Part of them that have to agree with the pose. Lowered: as above. Ours; not tuned.
    double min_inlier_ratio = 0.6;
    /// Observations that the image must have once its surroundings are adjusted: structure that was
    /// not asked for the pose confirms it. Raised: as above; lowered: wrong poses stay. Ours; not
    /// tuned.
    std::uint32_t min_observations = 40;
};

/// When pairs are seen through the lens that models have found since they were verified
/// (strong_lenses.h).
struct StrongLensOptions {
    /// Part of the longer side by which such a lens moves a corner of the photograph; 0: no lens
    /// is strong. Lowered: slower, and lenses that a few look-alikes invented are believed; raised:
    /// models of wide lenses contradict their pairs, which verification bent. Ours: lenses of
    /// phones and drones have 0.005 at most, a barrel of 5 per cent 0.09
    /// (docs/notebook/2026-11-29-strong-lenses.md).
    double min_displacement = 0.03;
    /// Pairs whose rotation differs from the recycled model's by so little are not looked at again
    /// [deg]. Lowered: slower, since the others are in each solve (docs/notebook/
    /// 2026-11-29-strong-lenses.md); raised: models contradict their pairs. Ours: half of
    /// max_edge_error_deg.
    double max_bend_deg = 5.0;
};

/// When a model gives way to another one (judge_model.h, mend_model.h, solve_new.h). None of it is
/// tuned.
struct ResetOptions {
    /// A contradiction that was kept is looked into again when it is so many times as large.
    /// Lowered: slower where rotations are ambiguous; raised: a model that has got worse lives on.
    double worse_by = 1.5;
    /// Of its cluster, the part that a model must hold; below that the cluster is solved new now
    /// and then, and cameras that are taken for one are tried apart. Raised: slower.
    double stuck_below = 0.75;
    /// Of the old model's images, and of its observations, the part that one with fewer
    /// contradictions must have. Lowered: a better shape at the price of images.
    double min_kept = 0.8;
    /// Of a cluster, the part that a start must hold for no other start to be made. Raised: slower.
    double enough = 0.5;
    /// Of the contradicting edges, the part that may be left in a model that was taken apart and
    /// joined again; and of its images, the part that it may lose by that. Raised: worse models
    /// live on; lowered: slower, since the cluster is solved new.
    double max_left = 0.5;
    double max_lost = 0.05;
};

struct SolveOptions {
    /// The sizes at which a solve changes its ways.
    SolvePolicy policy;
    GlobalOptions global;
    /// Edges that differ from the averaged rotations by more are dropped from the local graph
    /// [deg]. Higher: wrong pairs stay in; lower: noisy right ones go. Paper: rho_g,max = 10.
    double max_edge_error_deg = 10.0;
    FewPointsOptions few_points;
    /// Images of a model of more than policy.affordable_up_to that are adjusted where others were
    /// joined to it, beside these, at least. Raised: slower; lowered: what they differ by is spread
    /// over fewer. Ours; not tuned.
    std::uint32_t images_around_joint = 200;
    /// Images beside the new one whose poses move in a local adjustment. COLMAP 3.8: 6 in all.
    std::uint32_t local_neighbors = 5;
    /// Points that more images see than this stand still in it. Raised: slower where many images
    /// see each point; lowered: fewer points follow a new image. COLMAP 3.8: 15.
    std::uint32_t local_longest_track = 15;
    /// Points that an image shares with others to be adjusted with them, where a region of a model
    /// is: about what a pose is taken from at least. Raised: smaller regions, held by more;
    /// lowered: slower. Ours, for that reason; not tuned.
    std::uint32_t neighbor_points = 15;
    /// Part of a model above which a region of it is not adjusted, but all of it. Raised: hardly
    /// faster than all; lowered: slower. Not tuned.
    double max_region = 0.75;
    /// Images that are added before models that came along and found no joint are tried again;
    /// twice as many each time. Lowered: tried in vain more often; raised: more is built a second
    /// time. Not tuned.
    std::uint32_t join_again_after = 5;
    /// Part of a model's points up to which its surroundings are solved by themselves. Raised,
    /// above one half: hardly faster than all of it; lowered: slower. Not tuned.
    double max_surroundings = 0.75;
    /// What a weak edge weighs where rotations are averaged, beside others: it decides where
    /// nothing else does. Raised: wrong ones turn parts. Ours; not tuned.
    double weak_edge_weight = 1e-3;
    StrongLensOptions strong_lenses;
    /// Images of a camera that a published model must have for its intrinsics to be taken over in
    /// other clusters. Lowered: weak geometry's guesses spread; raised: each cluster guesses by
    /// itself. Not tuned.
    std::uint32_t images_to_hand_on = 10;
    /// Images with fewer observations after adjustment are taken out again. Ours; not tuned:
    /// half of the inliers that registration asks for.
    std::uint32_t min_observations = 10;
    /// A model whose relative rotations differ by more from the averaged ones contradicts itself
    /// [deg]. Higher: folded models live on; lower: drift is taken for a fold. Paper: rho_l,max =
    /// 10.
    double max_contradiction_deg = 10.0;
    /// Only the images that a contradiction comes down to are placed anew, when they are at most
    /// this part of the model; else the cluster is solved new. Raised: folds may be patched instead
    /// of undone; lowered: slower, since one wrong image gives up the work of hundreds. Ours; not
    /// tuned.
    double max_reset_images = 0.15;
    /// Part of the edges that may still contradict after a large model was taken apart and joined
    /// again: at such places it is the averaged
    /// rotations that are wrong. Raised: worse models live on; lowered: slower. Ours; not tuned.
    double max_contradicting_edges = 0.02;
    ResetOptions reset;
    /// When images that a model shows side by side are of different places.
    PlaceOptions places;
    /// When images that match and stand apart are brought together.
    LoopOptions loops;
    /// When a model is compared with others once no more images come.
    DoubtOptions doubt;

    /// When a model is none, and when it is a weak one.
    AssessmentOptions assessment;
    /// How two models that come together in a cluster are joined. Their cameras may interleave: the
    /// clustering has found that they belong together; whether they do is asked of the joined model
    /// (places).
    ClusterConstraintOptions transfer{.min_neighborhood_similarity = 0.0,
                                      .min_unmatched_cameras = 0};
    InitializationOptions initialization;
    AbsolutePoseOptions absolute_pose;
    TrackOptions tracks;
    AdjustmentOptions local_adjustment{
        .loss_scale_px = 1.0, .max_iterations = 25, .function_tolerance = 1e-5};
    RefinementOptions growth{
        .adjustment = {.loss_scale_px = 1.0, .max_iterations = 25, .function_tolerance = 1e-5},
        .max_rounds = 2,
        .points_per_image = 400};
    /// Of models of more than policy.converge_up_to that have grown or were joined. More or
    /// longer rounds: slower; fewer: they stay bent by more until they settle
    /// Ours (docs/notebook/2026-11-25-thousands-of-images.md).
    RefinementOptions large_growth{
        .adjustment = {.loss_scale_px = 1.0, .max_iterations = 5, .function_tolerance = 1e-4},
        .max_rounds = 1,
        .points_per_image = 200};
    RefinementOptions settling{.round_tolerance = 1e-4,
                               .images_for_principal_point = 5,
                               .points_per_image = 2500,
                               .thin_from_images = 200,
                               .noise = {.loss = 3.0, .max_error = 30.0}};
    LensOptions lenses;
    /// Parts joined by consensus, refined by least squares that let far-off edges go. The paper's
    /// L1 optimum folds rings whose wrong edges agree with one another; this does not, and takes a
    /// tenth of the time (docs/look-alikes.md).
    RotationAveragingOptions rotation_averaging{.consensus_deg = 10.0,
                                                .turn_again_factor = 10.0,
                                                .max_iterations = 0,
                                                .refine_iterations = 20};
    /// An edge counts with its inliers times its plausibility when rotations are averaged: many
    /// look-alikes a little way round a symmetric scene outnumber the few true edges between two
    /// parts that only just meet, and have as many inliers each. None: with its inliers, as in the
    /// paper. Ours (docs/look-alikes.md, "Rotations").
    std::optional<PlausibilityOptions> plausibility = PlausibilityOptions{};
    FocalCalibrationOptions focal_calibration;
    /// When cameras that may be one are not.
    TieOptions ties;
    VerifyOptions
        verification;  ///< of pairs whose focal lengths have become known since they were verified
};

Result<void> validate(const SolveOptions& options);

}  // namespace psfm
