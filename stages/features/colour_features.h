// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "graph/result.h"
#include "stages/features/run_features.h"

namespace psfm {

/// Adds what a photograph tells of features that another program has found in it: their colours,
/// and the metadata of its file in the place of those that are there.
/// @param features  whose size is that of their camera; coordinates of the stored pixel grid
/// @errors as run_features(); kInvalidArgument: the photograph has another size than its features
/// Thread-safe.
Result<void> add_photograph(const PhotoFile& photo, const FeatureOptions& options,
                            ExtractedPhoto& features);

}  // namespace psfm
