// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/verification/verify_options.h"

namespace psfm {
namespace {

bool is_share(double value) {
    return value > 0.0 && value <= 1.0;
}

Error invalid(const char* message) {
    return {ErrorCode::kInvalidArgument, message};
}

}  // namespace

Result<void> validate(const StillOptions& options) {
    if (!(options.max_motion_px > 0.0 && options.exact_side_px > 0.0 && options.max_turn_deg > 0.0))
        return invalid("still matches: max_motion_px, exact_side_px, max_turn_deg must be above 0");
    if (!(options.max_scale_ratio >= 1.0))
        return invalid("still matches: max_scale_ratio must be at least 1");
    if (!is_share(options.min_moving_share) || !is_share(options.min_agreeing) ||
        !is_share(options.min_coverage))
        return invalid("still matches: shares and coverage must be in (0, 1]");
    return {};
}

Result<void> validate(const VerifyOptions& options) {
    if (!(options.max_error_px > 0.0)) return invalid("verification: max_error_px must be above 0");
    if (!(options.max_uncalibrated_error_px > 0.0))
        return invalid("verification: max_uncalibrated_error_px must be above 0");
    if (!(options.refine_loss_px > 0.0))
        return invalid("verification: refine_loss_px must be above 0");
    if (options.min_inliers < 8) return invalid("verification: min_inliers must be at least 8");
    if (!(options.min_inlier_ratio >= 0.0 && options.min_inlier_ratio <= 1.0)) {
        return invalid("verification: min_inlier_ratio must be in [0, 1]");
    }
    if (!is_share(options.homography_ratio) || !is_share(options.rotation_ratio)) {
        return invalid("verification: homography_ratio and rotation_ratio must be in (0, 1]");
    }
    if (!(options.confidence > 0.0 && options.confidence < 1.0)) {
        return invalid("verification: confidence must be in (0, 1)");
    }
    if (options.max_iterations < 1)
        return invalid("verification: max_iterations must be at least 1");
    return validate(options.still);
}

VerifyOptions options_for(const VerifyOptions& options, const Camera& camera1,
                          const Camera& camera2) {
    const auto is_known = [](const Camera& camera) {
        return camera.focal_source == FocalSource::kExif ||
               camera.focal_source == FocalSource::kGiven;
    };
    VerifyOptions result = options;
    if (!is_known(camera1) || !is_known(camera2))
        result.max_error_px = options.max_uncalibrated_error_px;
    return result;
}

}  // namespace psfm
