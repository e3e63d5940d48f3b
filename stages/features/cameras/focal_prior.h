// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "stages/features/cameras/film_equivalent.h"
#include "stages/features/photographs/read_exif.h"

namespace psfm {

struct FocalPrior {
    std::optional<double> focal_px;  ///< nothing when EXIF does not tell, or tells the impossible
    /// It is but a guess, for the data to overrule: the photograph has a shape that no camera gives
    /// it, so that it was cropped, and EXIF does not tell from what; or it was zoomed digitally,
    /// and EXIF has a 35 mm equivalent alone, which some cameras write with that zoom and some
    /// without.
    bool is_vague = false;
};

/// Focal length [px] of a photograph of the given size from its EXIF data. In this order, the first
/// one that gives a possible value:
///  1. FocalLengthIn35mmFilm, compared with film of 36 x 24 mm as `film` says;
///  2. FocalLength and FocalPlaneXResolution;
///  3. FocalLength and the crop factor that Lensfun knows for make and model.
/// A photograph that was reduced, cropped or turned after the exposure is taken care of where EXIF
/// tells the original size: scaled by the larger of the two sides' ratios, since cropping only
/// takes away. Where it was cropped and EXIF does not tell, 2 comes first: pixels stay what they
/// were. Digital zoom makes 2 and 3 longer, which then come first for the same reason.
/// Thread-safe.
FocalPrior focal_prior(const ExifTags& tags, std::uint32_t width, std::uint32_t height,
                       FilmEquivalent film);

}  // namespace psfm
