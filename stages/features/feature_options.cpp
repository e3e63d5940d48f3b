// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/feature_options.h"

namespace psfm {

Result<void> validate(const FeatureOptions& options) {
    if (Result<void> read = validate(options.read); !read.ok()) return read.error();
    if (!(options.unknown_focal > 0.0))
        return Error{ErrorCode::kInvalidArgument, "features: unknown_focal must be positive"};
    return validate(options.sift);
}

}  // namespace psfm
