// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "graph/result.h"
#include "stages/features/photographs/photo_file.h"

namespace psfm {

/// Tells on stderr of masks that fit no photograph, and of photographs none of which has a mask.
/// @param masks  their folder
/// @param photos  in that of the photographs; without a path: known by name
/// @errors kNotFound (no such folder)
Result<void> tell_of_masks(const std::string& masks, const std::vector<PhotoFile>& photos);

}  // namespace psfm
