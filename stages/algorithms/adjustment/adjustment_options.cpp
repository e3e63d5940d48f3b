// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/adjustment/adjustment_options.h"

namespace psfm {

Result<void> validate(const AdjustmentOptions& options) {
    if (!(options.loss_scale_px > 0) || options.max_iterations < 1 ||
        !(options.function_tolerance > 0) || !(options.sigma_per_scale >= 0) ||
        !(options.principal_point_sigma > 0)) {
        return Error{ErrorCode::kInvalidArgument,
                     "bundle adjustment: scales, iterations and tolerance must be positive"};
    }
    return {};
}

}  // namespace psfm
