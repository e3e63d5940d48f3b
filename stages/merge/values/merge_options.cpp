// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/merge/values/merge_options.h"

#include <string>

namespace psfm {
namespace {

Error invalid(const std::string& what) {
    return {ErrorCode::kInvalidArgument, "merge options: " + what};
}

}  // namespace

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
    if (!(options.inlier_sigmas > 0.0)) return invalid("inlier_sigmas must be positive");
    if (options.samples < 1) return invalid("georeference.samples must be at least 1");
    return {};
}

Result<void> validate(const MergeOptions& options) {
    if (auto valid = validate(options.constraint); !valid.ok()) return valid.error();
    if (auto valid = validate(options.pose_graph); !valid.ok()) return valid.error();
    if (auto valid = validate(options.gravity); !valid.ok()) return valid.error();
    if (!(options.max_stayed_move > 0.0)) return invalid("max_stayed_move must be positive");
    return validate(options.georeference);
}

}  // namespace psfm
