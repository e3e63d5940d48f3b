// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "graph/result.h"
#include "stages/features/cameras/film_equivalent.h"
#include "stages/features/photographs/read_photo_options.h"
#include "stages/features/photographs/reduced_copy.h"
#include "stages/features/sift/sift_options.h"

namespace psfm {

/// Options of the features stage.
struct FeatureOptions {
    ReadPhotoOptions read;
    SiftOptions sift;
    /// Source: CIPA DCG-001; sceaux is 1.4 % off by it, 5.3 % by the long side (real_photos_test).
    FilmEquivalent film_equivalent = FilmEquivalent::kDiagonal;
    /// Focal length when nothing is known, over the longer side: 45 degrees of view, between a
    /// phone's main camera (about 0.75) and portrait lenses. Raised, lowered: solves of few
    /// photographs start farther off. Source: COLMAP 3.8, default_focal_length_factor.
    double unknown_focal = 1.2;
    /// When a photograph is a small copy of another one.
    SmallCopyOptions small_copies;
    /// Folder of masks (find_mask): no feature has its centre under one. Empty: none. Whatever a
    /// photograph says of its own transparency counts in any case.
    std::filesystem::path masks = {};
};

/// @errors kInvalidArgument, naming the field and its range
Result<void> validate(const FeatureOptions& options);

}  // namespace psfm
