// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "stages/features/feature_options.h"
#include "stages/features/read_exif.h"

namespace psfm {

/// Focal length [px] of a photograph of the given size from its EXIF data. In this order, the first
/// one that gives a possible value:
///  1. FocalLengthIn35mmFilm, compared with film of 36 x 24 mm as `film` says;
///  2. FocalLength and FocalPlaneXResolution;
///  3. FocalLength and the crop factor that Lensfun knows for make and model.
/// A photograph that was reduced, cropped or turned after the exposure is taken care of where EXIF
/// tells the original size: scaled by the larger of the two sides' ratios, since cropping only
/// takes away.
/// @return nothing when EXIF does not tell, or tells the impossible
/// Thread-safe.
std::optional<double> focal_prior_px(const ExifTags& tags, std::uint32_t width,
                                     std::uint32_t height, FilmEquivalent film);

}  // namespace psfm
