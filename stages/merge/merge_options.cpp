// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/merge/merge_options.h"

#include <string>

namespace psfm {
namespace {

Error invalid(const std::string& what) {
    return {ErrorCode::kInvalidArgument, "merge options: " + what};
}

}  // namespace

Result<void> validate(const ClusterConstraintOptions& options) {
    if (!(options.max_error > 0.0))
        return invalid("max_error must be positive; 0.005 is the default");
    if (options.min_edge_inliers < 3 || options.min_pair_inliers < 3) {
        return invalid(
            "min_edge_inliers and min_pair_inliers must be at least 3, the size of a sample");
    }
    if (!(options.min_inlier_ratio >= 0.0 && options.min_inlier_ratio <= 1.0)) {
        return invalid("min_inlier_ratio must be between 0 and 1");
    }
    if (!(options.min_neighborhood_similarity >= 0.0 &&
          options.min_neighborhood_similarity <= 1.0)) {
        return invalid(
            "min_neighborhood_similarity (lambda_s) must be between 0 and 1; 0.9 is the paper's");
    }
    if (!(options.companion_offset > 0.0 && options.companion_turn_deg > 0.0))
        return invalid("companion_offset and companion_turn_deg must be positive");
    if (!(options.max_unmatched_part >= 0.0 && options.max_unmatched_part <= 1.0))
        return invalid("max_unmatched_part must be between 0 and 1");
    if (!(options.confidence >= 0.0 && options.confidence < 1.0)) {
        return invalid("confidence must be at least 0 and below 1");
    }
    if (options.max_ransac_iterations < 1)
        return invalid("max_ransac_iterations must be at least 1");
    return {};
}

Result<void> validate(const PoseGraphOptions& options) {
    if (!(options.huber_scale > 0.0)) return invalid("huber_scale must be positive");
    if (!(options.max_residual > 0.0)) return invalid("max_residual must be positive");
    if (options.max_iterations < 1) return invalid("max_iterations must be at least 1");
    return {};
}

Result<void> validate(const GravityOptions& options) {
    if (!(options.roll_sigma_deg > 0.0 && options.pitch_sigma_deg > 0.0 &&
          options.min_sigma_deg > 0.0)) {
        return invalid("the standard deviations of gravity must be positive");
    }
    if (!(options.min_mean_up >= 0.0 && options.min_mean_up <= 1.0))
        return invalid("min_mean_up must be between 0 and 1");
    return {};
}

Result<void> validate(const GeoreferenceOptions& options) {
    if (!(options.horizontal_sigma_m > 0.0 && options.vertical_sigma_m > 0.0))
        return invalid("the standard deviations of positions must be positive");
    if (options.min_positions < 3)
        return invalid("min_positions must be at least 3: two cannot contradict each other");
    if (!(options.min_inlier_ratio >= 0.0 && options.min_inlier_ratio <= 1.0))
        return invalid("georeference.min_inlier_ratio must be between 0 and 1");
    if (!(options.max_heading_sigma > 0.0)) return invalid("max_heading_sigma must be positive");
    if (!(options.hold >= 0.0 && options.hold_angle_deg >= 0.0))
        return invalid("hold and hold_angle_deg must not be negative");
    if (options.samples < 1) return invalid("georeference.samples must be at least 1");
    return {};
}

Result<void> validate(const MergeOptions& options) {
    if (auto valid = validate(options.constraint); !valid) return valid;
    if (auto valid = validate(options.pose_graph); !valid) return valid;
    if (auto valid = validate(options.gravity); !valid) return valid;
    return validate(options.georeference);
}

}  // namespace psfm
