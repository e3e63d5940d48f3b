// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "graph/image.h"
#include "stages/features/cameras/film_equivalent.h"
#include "stages/features/photographs/read_photo.h"

namespace psfm {

/// What a decoded photograph's file says of itself. Thread-safe.
PhotoMetadata photo_metadata(const DecodedPhoto& photo, FilmEquivalent film);

}  // namespace psfm
