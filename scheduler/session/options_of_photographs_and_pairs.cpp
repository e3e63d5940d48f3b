// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <array>

#include "scheduler/session/named_options.h"

namespace psfm {
namespace {

// clang-format off
constexpr std::array kPhotographAndPairOptions{
    PSFM_OPTION(features.film_equivalent, 0, 1, "35 mm equivalents compare diagonals (0) or longer sides (1)", "CIPA DCG-001; features_real_test"),
    PSFM_OPTION(features.read.max_file_mib, 1, kCount, "longer files are refused [MiB]", "ours; not tuned: 200 megapixels of 16-bit RGB fit"),
    PSFM_OPTION(features.read.max_megapixels, 0.01, 1e5, "larger photographs are refused", "ours; not tuned: above any camera's of 2026"),
    PSFM_OPTION(features.read.min_side_px, 1, kCount, "smaller photographs are refused", "ours; not tuned: two windows of a descriptor"),
    PSFM_OPTION(features.sift.contrast_threshold, 1e-4, 1, "least contrast of a feature", "COLMAP 3.8, peak_threshold"),
    PSFM_OPTION(features.sift.edge_threshold, 1.01, 1000, "largest ratio of a feature's principal curvatures", "Lowe 2004, sec. 4.1; COLMAP 3.8"),
    PSFM_OPTION(features.sift.max_features, 1, 1e6, "most places of a photograph that have features", "COLMAP 3.8, max_num_features"),
    PSFM_OPTION(features.sift.max_image_size, 64, 30000, "longer side to which photographs are reduced for detection [px]", "COLMAP 3.8, max_image_size"),
    PSFM_OPTION(features.sift.max_orientations, 1, 36, "most orientations of a place, a feature each", "COLMAP 3.8, max_num_orientations"),
    PSFM_OPTION(features.sift.octave_layers, 1, 16, "layers in an octave of the scale space", "Lowe 2004, sec. 3.2"),
    PSFM_OPTION(features.sift.sigma, 0.5, 8, "blur of the first layer [px of the doubled image]", "Lowe 2004, sec. 3.3"),
    PSFM_OPTION(features.sift.strip_mib, 1, 65536, "the scale space is made in strips of so much [MiB]; changes no result", "ours: a third of the rows at 6,400 px; docs/features.md, \"In strips\""),
    PSFM_OPTION(features.small_copies.max_part, 0, 1, "sides of a small copy, over the photograph's", "ours; picture_signature_test"),
    PSFM_OPTION(features.small_copies.min_contrast, 0, 255, "standard deviation of a photograph that can be told from others [grey values]", "ours; picture_signature_test"),
    PSFM_OPTION(features.small_copies.min_correlation, 0, 1, "correlation of a copy's fields with the photograph's", "ours; picture_signature_test"),
    PSFM_OPTION(features.small_copies.min_details, 0, 255, "standard deviation of details that tell it [grey values]", "ours; picture_signature_test"),
    PSFM_OPTION(features.small_copies.min_in_details, 0, 1, "correlation of a copy's details", "ours; picture_signature_test"),
    PSFM_OPTION(features.unknown_focal, 0.01, 1000, "focal length where nothing is known, over the longer side", "COLMAP 3.8, default_focal_length_factor"),

    PSFM_OPTION(retrieval.candidates, 1, kCount, "candidates of an image among earlier ones", "paper, \"Progressive Viewgraph\""),
    PSFM_OPTION(retrieval.features_per_image, 1, kCount, "features of an image that are indexed and looked up", "ours; docs/retrieval.md"),
    PSFM_OPTION(retrieval.max_postings, 1, kCount, "entries of the inverted file read for a query, rarest words first", "ours; docs/retrieval.md"),
    PSFM_OPTION(retrieval.max_training_images, 1, kCount, "images up to which a vocabulary is trained again from the session; then an independent one takes over", "ours; docs/retrieval.md"),
    PSFM_OPTION(retrieval.max_words, 2, kCount, "most words of a trained vocabulary", "ours; docs/retrieval.md"),
    PSFM_OPTION(retrieval.training_features, 2, kCount, "descriptors that a vocabulary is trained from", "ours: four for each of max_words; docs/retrieval.md"),
    PSFM_OPTION(retrieval.training_iterations, 1, 1000, "iterations of k-means at each of its two levels", "ours; not tuned"),
    PSFM_OPTION(retrieval.vouched_beyond, 0, 1e6, "images for each candidate up to which similarity finds what overlaps", "ours; docs/retrieval.md"),
    PSFM_OPTION(retrieval.vouched_part, 0, 1, "part of the candidates of larger collections that the most similar images have edges with", "ours; docs/retrieval.md"),
    PSFM_OPTION(retrieval.words_per_image, 1, kCount, "words of a trained vocabulary for each image present", "ours; docs/retrieval.md"),

    PSFM_OPTION(verification.cells.iterations, 1, 1000, "iterations of k-means over descriptors", "ours; not tuned"),
    PSFM_OPTION(verification.cells.max_excess, 0, 4, "how much farther cells of descriptors are looked into", "ours; docs/matching.md"),
    PSFM_OPTION(verification.cells.min_rows, 0, kCount, "images with fewer features are compared whole", "ours; match_descriptors_bench"),
    PSFM_OPTION(verification.cells.min_strongest_matches, 0, kCount, "matches of the strongest features that a pair needs", "ours; docs/matching.md"),
    PSFM_OPTION(verification.cells.rows_per_cell, 1, kCount, "descriptors of a cell, about", "ours; docs/matching.md"),
    PSFM_OPTION(verification.cells.strongest_rows, 1, kCount, "features of largest scale that are compared first", "ours; docs/matching.md"),
    PSFM_OPTION(verification.enough_pairs, 0, kCount, "verified pairs after which ranked candidates are not tried any more; 0: all", "ours; docs/matching.md"),
    PSFM_OPTION(verification.match.max_distance, 0, 2, "largest distance of two matching descriptors", "COLMAP 3.8, max_distance"),
    PSFM_OPTION(verification.match.max_ratio, 0, 1, "nearest over second nearest distance of a match", "Lowe 2004, sec. 7.1; COLMAP 3.8"),
    PSFM_OPTION(verification.verify.confidence, 0, 1, "chance of one clean sample at which RANSAC stops", "COLMAP 3.8"),
    PSFM_OPTION(verification.verify.homography_ratio, 0, 1, "share of the inliers with which a homography explains a pair", "COLMAP 3.8, max_H_inlier_ratio"),
    PSFM_OPTION(verification.verify.max_error_px, 0.01, 1000, "epipolar error of an inlier [px]", "ours, on Strecha's scenes; docs/verification.md"),
    PSFM_OPTION(verification.verify.max_iterations, 1, 1e8, "RANSAC iterations of a pair", "ours; docs/verification.md"),
    PSFM_OPTION(verification.verify.max_uncalibrated_error_px, 0.01, 1000, "the same where a focal length is unknown [px]", "ours, on kitchen: 19 of 25 are placed with 2 px, all with 3"),
    PSFM_OPTION(verification.verify.min_inlier_ratio, 0, 1, "share of the matches that a verified pair needs", "ours, on Strecha's scenes and kitchen; docs/verification.md"),
    PSFM_OPTION(verification.verify.min_inliers, 8, 1e6, "inliers that a verified pair needs", "COLMAP 3.8, min_num_inliers"),
    PSFM_OPTION(verification.verify.refine_loss_px, 0.001, 1000, "scale of the Cauchy loss in the refinement of a pair [px]", "ours; docs/verification.md"),
    PSFM_OPTION(verification.verify.rotation_ratio, 0, 1, "share of a homography's inliers with which a mere turn explains a pair", "ours; docs/verification.md"),
    PSFM_OPTION(verification.verify.still.exact_side_px, 1, 1e6, "longer side up to which max_motion_px is meant [px]", "ours, on datasets/cases; not tuned further"),
    PSFM_OPTION(verification.verify.still.max_motion_px, 0, 1000, "matches that move by less lie at one place [px]", "ours, on datasets/cases; docs/verification.md, \"What stands still\""),
    PSFM_OPTION(verification.verify.still.max_scale_ratio, 1, 100, "ratio of the scales of matches at one place", "ours, on datasets/cases; not tuned further"),
    PSFM_OPTION(verification.verify.still.max_turn_deg, 0, 180, "turn of matches at one place [deg]", "ours, on datasets/cases; not tuned further"),
    PSFM_OPTION(verification.verify.still.min_agreeing, 0, 1, "share of what stands still that moves with the scene where it belongs to it", "ours, on datasets/cases; not tuned further"),
    PSFM_OPTION(verification.verify.still.min_coverage, 0, 1, "share of a photograph that stands still before a camera that did", "ours, on datasets/cases; not tuned further"),
    PSFM_OPTION(verification.verify.still.coverage_grid, 1, 1024, "squares along each side by which that is counted", "ours; not tuned"),
    PSFM_OPTION(verification.verify.still.min_kept, 0, 1, "share of what moves that agrees with the geometry of all matches of a far view", "ours; not tuned"),
    PSFM_OPTION(verification.verify.still.min_matches, 0, kCount, "matches at one place of both photographs that are looked at twice; 0: none are", "ours, on datasets/cases; docs/verification.md, \"What stands still\""),
    PSFM_OPTION(verification.verify.still.min_moving_share, 0, 1, "share of what moves that has to agree to be a scene", "ours, on datasets/cases; not tuned further"),

    PSFM_OPTION(edges.min_inliers, 1, kCount, "verified inliers that an edge of the view graph needs", "ours, on temple-341; docs/look-alikes.md"),
    PSFM_OPTION(edges.min_relative_plausibility, 0, 1, "part of the best plausibility of its images that an edge needs", "ours; docs/look-alikes.md, \"Relative plausibility\""),
    PSFM_OPTION(edges.min_weak_inliers, 0, kCount, "verified inliers that a weak edge needs; 0: there are none", "COLMAP 3.8, min_num_inliers"),
    PSFM_OPTION(edges.plausibility.core.at_zero, 0, 10, "density of matches expected in the core, for equal viewing directions", "ours; docs/look-alikes.md, \"Relative plausibility\""),
    PSFM_OPTION(edges.plausibility.core.decay_deg, 0.01, 360, "turn by which it decays [deg]", "ours; docs/look-alikes.md, \"Relative plausibility\""),
    PSFM_OPTION(edges.plausibility.core.floor, 0, 10, "and to what", "ours; docs/look-alikes.md, \"Relative plausibility\""),
    PSFM_OPTION(edges.plausibility.max_plausibility, 0.01, 1000, "plausibilities count up to here", "ours; not tuned"),
    PSFM_OPTION(edges.plausibility.shared.at_zero, 0, 10, "density of matches expected of what both show, for equal viewing directions", "ours; docs/look-alikes.md, \"Relative plausibility\""),
    PSFM_OPTION(edges.plausibility.shared.decay_deg, 0.01, 360, "turn by which it decays [deg]", "ours; docs/look-alikes.md, \"Relative plausibility\""),
    PSFM_OPTION(edges.plausibility.shared.floor, 0, 10, "and to what", "ours; docs/look-alikes.md, \"Relative plausibility\""),
    PSFM_OPTION(edges.still.max_moving, 0, 10, "pairs that show a feature move, over those that show it stand still", "ours, on datasets/cases; not tuned further"),
    PSFM_OPTION(edges.still.min_inliers, 0, kCount, "inliers of the scene that an edge keeps", "verification.verify.min_inliers"),
    PSFM_OPTION(edges.still.min_pairs, 0, kCount, "pairs that show a feature stand still before it counts for no scene; 0: it always does", "ours, on datasets/cases; not tuned further"),
    PSFM_OPTION(edges.still.min_part, 0, 1, "part of an edge's inliers that are of the scene", "ours, on datasets/cases; not tuned further"),

    PSFM_OPTION(clustering.eta, 0, 1, "distance below which two images are in one cluster", "paper, \"Implementation\""),
    PSFM_OPTION(clustering.form, 0, 1, "the distance of two images: with themselves among their neighbours (0), or as printed (1)", "ours; docs/design.md"),
    PSFM_OPTION(clustering.hold_part, 1e-6, 1, "part of join_up_to below which a cluster joins one of any size", "ours; not tuned"),
    PSFM_OPTION(clustering.join_below, 0, 1000, "images that a group needs to stay by itself; 0: any does", "ours: twice the paper's mu_min puts kitchen into one part; not tuned further"),
    PSFM_OPTION(clustering.join_up_to, 0, kCount, "images up to which large clusters join while images stream in; 0: always", "ours; docs/performance.md"),
};
// clang-format on

}  // namespace

std::span<const NamedOption> options_of_photographs_and_pairs() {
    return kPhotographAndPairOptions;
}

}  // namespace psfm
