// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/model/between_options.h"

#include <string>

namespace psfm {

Result<void> validate(const BetweenOptions& options) {
    const auto invalid = [](const char* what) {
        return Error{ErrorCode::kInvalidArgument, std::string("between: ") + what};
    };
    if (!(options.slack_deg >= 0.0)) return invalid("slack_deg is negative");
    if (options.grid < 1 || options.grid > 64) return invalid("grid must be from 1 to 64");
    if (!(options.min_spread_deg >= 0.0 && options.max_spread_deg > options.min_spread_deg &&
          options.max_spread_deg < 180.0))
        return invalid("spreads must be ascending and below 180 degrees");
    if (!(options.size_slack >= 0.0 && options.size_slack < 1.0))
        return invalid("size_slack must be at least 0 and below 1");
    if (!(options.max_angle_deg > 0.0 && options.max_angle_deg < 90.0))
        return invalid("max_angle_deg must be between 0 and 90");
    if (options.min_asked == 0) return invalid("min_asked must be at least 1");
    if (!(options.max_offset > 0.0)) return invalid("max_offset must be positive");
    if (!(options.margin >= 0.0 && options.margin < 0.5))
        return invalid("margin must be at least 0 and below 0.5");
    if (options.min_track < 2 || options.max_track < options.min_track)
        return invalid("min_track must be at least 2, and max_track at least min_track");
    return {};
}

}  // namespace psfm
