// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/model/place_options.h"

#include <string>

namespace psfm {

Result<void> validate(const PlaceOptions& options) {
    const auto invalid = [](const char* what) {
        return Error{ErrorCode::kInvalidArgument, std::string("places: ") + what};
    };
    if (!(options.max_offset > 0.0) || !(options.max_turn_deg > 0.0))
        return invalid("max_offset and max_turn_deg must be positive");
    if (options.min_track < 2) return invalid("a track has two images at least");
    if (options.min_expected == 0) return invalid("min_expected must be at least 1");
    if (!(options.same_place > 0.0 && options.same_place < 1.0))
        return invalid("same_place must be between 0 and 1");
    if (!(options.edge_weight >= 0.0)) return invalid("edge_weight is negative");
    if (!(options.max_shared_by_chance >= 0.0 && options.max_shared_by_chance < options.same_place))
        return invalid("max_shared_by_chance must be between 0 and same_place");
    if (options.reached_rank == 0 || options.glance_points == 0)
        return invalid("reached_rank and glance_points must be at least 1");
    if (!(options.margin >= 0.0 && options.margin < 0.5))
        return invalid("margin must be at least 0 and below 0.5");
    if (!(options.same_between > 0.0 && options.same_between < 1.0))
        return invalid("same_between must be between 0 and 1");
    if (options.between_points == 0 || options.full_between == 0)
        return invalid("between_points and full_between must be at least 1");
    if (options.left_out > 1) return invalid("left_out is 0 or 1");
    return validate(options.between);
}

}  // namespace psfm
