// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/clustering/clustering_options.h"

#include <string>

namespace psfm {

Result<void> validate(const ClusteringOptions& options) {
    if (!(options.eta >= 0.0 && options.eta <= 1.0)) {
        return Error{ErrorCode::kInvalidArgument,
                     "clustering: eta is " + std::to_string(options.eta) +
                         "; give a distance between 0 and 1, 0.2 is the default"};
    }
    return {};
}

}  // namespace psfm
