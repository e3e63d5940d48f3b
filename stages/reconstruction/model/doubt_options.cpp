// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/model/doubt_options.h"

#include <string>

namespace psfm {

Result<void> validate(const DoubtOptions& options) {
    const auto invalid = [](const char* what) {
        return Error{ErrorCode::kInvalidArgument, std::string("doubt: ") + what};
    };
    if (options.grid < 1 || options.grid > 64) return invalid("grid must be from 1 to 64");
    if (!(options.max_angle_deg > 0.0 && options.max_angle_deg < 90.0))
        return invalid("max_angle_deg must be between 0 and 90");
    if (!(options.max_scale >= 1.0)) return invalid("max_scale must be at least 1");
    if (!(options.min_expected > 0.0)) return invalid("min_expected must be positive");
    if (!(options.unknown_rate > 0.0 && options.unknown_rate <= 1.0))
        return invalid("unknown_rate must be above 0 and at most 1");
    if (options.min_track < 2) return invalid("a track has two images at least");
    if (!(options.min_missing_part > 0.0 && options.min_missing_part <= 1.0))
        return invalid("min_missing_part must be above 0 and at most 1");
    if (!(options.as_well_explained >= 0.0 && options.as_well_explained <= 1.0))
        return invalid("as_well_explained must be from 0 to 1");
    if (!(options.min_rivalry >= 0.0)) return invalid("min_rivalry must not be negative");
    return {};
}

}  // namespace psfm
