// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/model/tie_options.h"

namespace psfm {

Result<void> validate(const TieOptions& options) {
    if (!(options.min_gain >= 1.0) || !(options.excused_px >= 0.0) ||
        !(options.min_deviation > 0.0) || !(options.max_step > 0.0) || options.max_zooms == 0 ||
        !(options.min_zoom_gain >= 1.0) || options.points_per_image == 0 ||
        options.max_iterations < 1) {
        return Error{
            ErrorCode::kInvalidArgument,
            "ties of cameras: min_gain and min_zoom_gain are at least 1, the others are above 0"};
    }
    return {};
}

}  // namespace psfm
