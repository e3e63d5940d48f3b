// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "graph/result.h"
#include "stages/features/cameras/film_equivalent.h"
#include "stages/features/photographs/read_photo_options.h"
#include "stages/features/sift/sift_options.h"

namespace psfm {

/// Options of the features stage.
struct FeatureOptions {
    ReadPhotoOptions read;
    SiftOptions sift;
    /// Source: CIPA DCG-001; sceaux is 1.4 % off by it, 5.3 % by the long side (real_photos_test).
    FilmEquivalent film_equivalent = FilmEquivalent::kDiagonal;
    /// Folder of masks (find_mask): no feature has its centre under one. Empty: none. Whatever a
    /// photograph says of its own transparency counts in any case.
    std::filesystem::path masks = {};
};

/// @errors kInvalidArgument, naming the field and its range
Result<void> validate(const FeatureOptions& options);

}  // namespace psfm
