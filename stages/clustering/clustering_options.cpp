// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/clustering/clustering_options.h"

#include <algorithm>
#include <string>

namespace psfm {

bool may_join(std::size_t a, std::size_t b, const ClusteringOptions& options) {
    return options.join_up_to == 0 || a + b <= options.join_up_to ||
           std::min(a, b) < options.hold_from;
}

Result<void> validate(const ClusteringOptions& options) {
    if (!(options.eta >= 0.0 && options.eta <= 1.0)) {
        return Error{ErrorCode::kInvalidArgument,
                     "clustering: eta is " + std::to_string(options.eta) +
                         "; give a distance between 0 and 1, 0.2 is the default"};
    }
    if (options.join_up_to > 0 && options.hold_from < 2) {
        return Error{ErrorCode::kInvalidArgument,
                     "clustering: hold_from is below 2, so that single images would be held apart"};
    }
    return {};
}

}  // namespace psfm
