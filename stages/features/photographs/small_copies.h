// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "stages/features/photographs/photo_file.h"
#include "stages/features/photographs/reduced_copy.h"

namespace psfm {

/// Puts photographs that are small copies of others (is_reduced_copy), as previews and thumbnails
/// are, behind all others, so that a session meets the larger one first and can turn the small one
/// down. Only those whose file names say that they may be one are looked at: of small/a.jpg,
/// a_small.jpg, thumb-a.png beside a.jpg the names without extension begin or end with the other's.
/// What cannot be read stays where it is. Cost: the header of each file that shares its name, and
/// the pixels of those of equal proportions, the larger ones at an eighth of their size.
/// Thread-safe.
void put_small_copies_last(std::vector<PhotoFile>& photos, const SmallCopyOptions& options);

}  // namespace psfm
