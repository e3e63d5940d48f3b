// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/model/loop_options.h"

#include <string>

namespace psfm {

Result<void> validate(const LoopOptions& options) {
    const auto invalid = [](const char* what) {
        return Error{ErrorCode::kInvalidArgument, std::string("loops: ") + what};
    };
    if (options.min_matches < 3) return invalid("a similarity takes three matches at least");
    if (!(options.max_shared_part >= 0.0 && options.max_shared_part < 1.0))
        return invalid("max_shared_part must be in [0, 1)");
    if (!(options.min_gap > 0.0) || !(options.max_residual > 0.0))
        return invalid("min_gap and max_residual must be positive");
    if (options.edges_per_image == 0 || options.max_iterations == 0)
        return invalid("edges_per_image and max_iterations must be at least 1");
    if (!(options.max_lost_observations >= 0.0))
        return invalid("max_lost_observations is negative");
    if (!(options.min_strain > 0.0) || !(options.max_torn >= 0.0) ||
        !(options.drift_loss_scale > 0.0))
        return invalid("min_strain and drift_loss_scale must be positive, max_torn not negative");
    if (options.images_per_group == 0) return invalid("images_per_group must be at least 1");
    return {};
}

}  // namespace psfm
