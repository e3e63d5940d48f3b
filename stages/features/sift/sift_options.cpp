// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/sift/sift_options.h"

#include "stages/algorithms/math/check_ranges.h"

namespace psfm {

Result<void> validate(const SiftOptions& options) {
    return check_ranges({{"max_image_size", static_cast<double>(options.max_image_size), 64, 30000},
                         {"max_features", static_cast<double>(options.max_features), 1, 1e6},
                         {"max_orientations", static_cast<double>(options.max_orientations), 1, 36},
                         {"octave_layers", static_cast<double>(options.octave_layers), 1, 10},
                         {"contrast_threshold", options.contrast_threshold, 1e-4, 1},
                         {"edge_threshold", options.edge_threshold, 1.01, 1000},
                         {"sigma", options.sigma, 1.01, 10},
                         {"strip_mib", static_cast<double>(options.strip_mib), 1, 65536}});
}

}  // namespace psfm
