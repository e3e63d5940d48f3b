// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/photographs/read_photo_options.h"

#include "stages/algorithms/math/check_ranges.h"

namespace psfm {

Result<void> validate(const ReadPhotoOptions& options) {
    return check_ranges({{"min_side_px", static_cast<double>(options.min_side_px), 16, 1e5},
                         // OpenCV refuses more than 2^30 pixels by itself.
                         {"max_megapixels", options.max_megapixels, 0.001, 1000},
                         {"max_file_mib", static_cast<double>(options.max_file_mib), 1, 8192}});
}

}  // namespace psfm
