// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/alignment/alignment_options.h"

#include <string>

namespace psfm {
namespace {

Error invalid_alignment(const std::string& what) {
    return {ErrorCode::kInvalidArgument, "merge options: " + what};
}

}  // namespace

Result<void> validate(const ClusterConstraintOptions& options) {
    if (!(options.max_error > 0.0))
        return invalid_alignment("max_error must be positive; 0.005 is the default");
    if (options.min_edge_inliers < 3 || options.min_pair_inliers < 3) {
        return invalid_alignment(
            "min_edge_inliers and min_pair_inliers must be at least 3, the size of a sample");
    }
    if (!(options.min_inlier_ratio >= 0.0 && options.min_inlier_ratio <= 1.0)) {
        return invalid_alignment("min_inlier_ratio must be between 0 and 1");
    }
    if (!(options.min_neighborhood_similarity >= 0.0 &&
          options.min_neighborhood_similarity <= 1.0)) {
        return invalid_alignment(
            "min_neighborhood_similarity (lambda_s) must be between 0 and 1; 0.9 is the paper's");
    }
    if (!(options.companion_offset > 0.0 && options.companion_turn_deg > 0.0))
        return invalid_alignment("companion_offset and companion_turn_deg must be positive");
    if (!(options.max_unmatched_part >= 0.0 && options.max_unmatched_part <= 1.0))
        return invalid_alignment("max_unmatched_part must be between 0 and 1");
    if (!(options.min_weak_part >= 0.0 && options.min_weak_part <= 1.0))
        return invalid_alignment("min_weak_part must be between 0 and 1");
    if (!(options.confidence >= 0.0 && options.confidence < 1.0)) {
        return invalid_alignment("confidence must be at least 0 and below 1");
    }
    if (options.max_ransac_iterations < 1)
        return invalid_alignment("max_ransac_iterations must be at least 1");
    return {};
}

Result<void> validate(const PoseGraphOptions& options) {
    if (!(options.huber_scale > 0.0)) return invalid_alignment("huber_scale must be positive");
    if (!(options.max_residual > 0.0)) return invalid_alignment("max_residual must be positive");
    if (options.max_iterations < 1) return invalid_alignment("max_iterations must be at least 1");
    return {};
}

}  // namespace psfm
