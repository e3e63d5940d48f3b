// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/model/assessment_options.h"

namespace psfm {

Result<void> validate(const AssessmentOptions& options) {
    if (!(options.min_turn_deg >= 0.0 && options.max_turn_parallax_deg > 0.0 &&
          options.weak_angle_deg >= 0.0 && options.max_invented >= 0.0 &&
          options.max_invented <= 1.0 && options.min_turns >= 0.0 &&
          options.min_relative_focal > 0.0 && options.max_focal_factor >= 1.0)) {
        return Error{ErrorCode::kInvalidArgument,
                     "assessment: an angle, a part or a factor is out of its range"};
    }
    return {};
}

}  // namespace psfm
