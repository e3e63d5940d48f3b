// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/cameras/photo_metadata.h"

#include "stages/features/cameras/focal_prior.h"

namespace psfm {

PhotoMetadata photo_metadata(const DecodedPhoto& photo, FilmEquivalent film) {
    const ExifTags& tags = photo.exif;
    PhotoMetadata metadata;
    metadata.width = static_cast<std::uint32_t>(photo.colour.cols);
    metadata.height = static_cast<std::uint32_t>(photo.colour.rows);
    metadata.content_hash = photo.content_hash;
    metadata.make = tags.make;
    metadata.model = tags.model;
    const FocalPrior prior = focal_prior(tags, metadata.width, metadata.height, film);
    metadata.focal_px = prior.focal_px;
    metadata.focal_is_vague = prior.is_vague;
    metadata.digital_zoom = tags.digital_zoom;
    metadata.focal_mm = tags.focal_mm;
    // HEIF pictures come upright; see decode_heif().
    metadata.orientation = photo.format == PhotoFormat::kHeif ? std::uint8_t{1} : tags.orientation;
    metadata.gps = tags.gps;
    return metadata;
}

}  // namespace psfm
