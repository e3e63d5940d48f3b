// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/model/solve_options.h"

namespace psfm {

Result<void> validate(const GlobalOptions& options) {
    for (const Result<void>& part : {validate(options.directions), validate(options.positions),
                                     validate(options.adjustment)}) {
        if (!part.ok()) return part.error();
    }
    if (!(options.track_weight > 0) || !(options.start_error_px > 0) ||
        options.calibration_images < 2 || options.adjusted_tracks_per_image == 0 ||
        !(options.round_tolerance > 0)) {
        return Error{ErrorCode::kInvalidArgument,
                     "global reconstruction: track_weight, start_error_px, round_tolerance and "
                     "adjusted_tracks_per_image must be positive, calibration_images 2 at least"};
    }
    return {};
}

Result<void> validate(const SolveOptions& options) {
    for (const Result<void>& part :
         {validate(options.absolute_pose), validate(options.tracks),
          validate(options.local_adjustment), validate(options.growth.adjustment),
          validate(options.large_growth.adjustment), validate(options.settling.adjustment),
          validate(options.rotation_averaging), validate(options.global), validate(options.policy),
          validate(options.places), validate(options.loops), validate(options.ties),
          validate(options.assessment), validate(options.doubt)}) {
        if (!part.ok()) return part.error();
    }
    if (!(options.max_edge_error_deg > 0))
        return Error{ErrorCode::kInvalidArgument, "rho_g,max must be positive"};
    if (options.plausibility) {
        if (auto valid = validate(*options.plausibility); !valid.ok()) return valid.error();
    }
    if (!(options.few_points.min_inlier_ratio > 0) || !(options.few_points.min_inlier_ratio <= 1) ||
        (options.few_points.min_points > 0 && options.few_points.min_points < 4)) {
        return Error{ErrorCode::kInvalidArgument,
                     "a pose needs four points, and agrees with a part of them, at most all"};
    }
    const ResetOptions& reset = options.reset;
    if (!(reset.worse_by >= 1) || !(reset.stuck_below >= 0) || !(reset.min_kept >= 0) ||
        !(reset.enough >= 0) || !(reset.max_left >= 0) || !(reset.max_lost >= 0) ||
        !(options.max_region >= 0)) {
        return Error{ErrorCode::kInvalidArgument,
                     "worse_by is at least 1; the other bounds of reset, and max_region, are parts "
                     "of a whole, not negative"};
    }
    if (!(options.max_reset_images >= 0) || !(options.max_contradicting_edges >= 0)) {
        return Error{ErrorCode::kInvalidArgument,
                     "max_reset_images and max_contradicting_edges are parts of a whole, not "
                     "negative"};
    }
    if (options.initialization.max_pairs == 0 || options.growth.max_rounds < 1 ||
        options.large_growth.max_rounds < 1 || options.settling.max_rounds < 1) {
        return Error{ErrorCode::kInvalidArgument, "pairs and rounds must be at least 1"};
    }
    for (const RefinementOptions* refinement :
         {&options.growth, &options.large_growth, &options.settling}) {
        if (!(refinement->max_change >= 0) || !(refinement->round_tolerance >= 0))
            return Error{ErrorCode::kInvalidArgument,
                         "max_change and round_tolerance must not be negative"};
    }
    return {};
}

}  // namespace psfm
