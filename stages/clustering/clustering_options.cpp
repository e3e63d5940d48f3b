// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/clustering/clustering_options.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace psfm {

bool may_join(std::size_t a, std::size_t b, const ClusteringOptions& options) {
    if (options.join_up_to == 0 || a + b <= options.join_up_to) return true;
    constexpr double kRounding = 1e-12;  // Guard: a part of whole numbers gives them back
    const double held_from = std::ceil(options.hold_part * options.join_up_to * (1.0 - kRounding));
    const std::size_t smaller = std::min(a, b);
    return smaller == 1 || static_cast<double>(smaller) < held_from;
}

Result<void> validate(const ClusteringOptions& options) {
    if (!(options.eta >= 0.0 && options.eta <= 1.0)) {
        return Error{ErrorCode::kInvalidArgument,
                     "clustering: eta is " + std::to_string(options.eta) +
                         "; give a distance between 0 and 1, 0.2 is the default"};
    }
    if (!(options.hold_part > 0.0 && options.hold_part <= 1.0)) {
        return Error{ErrorCode::kInvalidArgument,
                     "clustering: hold_part is " + std::to_string(options.hold_part) +
                         "; give a part above 0 and up to 1, 0.1 is the default"};
    }
    return {};
}

}  // namespace psfm
