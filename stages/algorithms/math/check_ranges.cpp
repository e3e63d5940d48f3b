// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/math/check_ranges.h"

#include <string>

namespace psfm {

Result<void> check_ranges(std::initializer_list<Range> ranges) {
    for (const Range& range : ranges) {
        if (range.value >= range.low && range.value <= range.high) continue;
        return Error{ErrorCode::kInvalidArgument,
                     std::string(range.name) + " is " + std::to_string(range.value) +
                         "; give a value from " + std::to_string(range.low) + " to " +
                         std::to_string(range.high)};
    }
    return {};
}

}  // namespace psfm
