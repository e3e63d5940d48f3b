// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "graph/result.h"
#include "stages/features/photographs/photo_file.h"

namespace psfm {

/// Takes files that are masks of others out of a list of photographs:
///   - all in and below the folder of masks that is given, if that lies among the photographs;
///   - a.jpg.png and a_mask.png beside a.jpg;
///   - all of a folder named "mask" or "masks", in any case, where one of its files has the name of
///     a mask of a photograph elsewhere (mask_names). A name that a photograph itself may have
///     counts only if the picture is black and white, so that nobody's photographs of masks get
///     lost.
/// @param photos  of one folder, in any order; keeps its order
/// @param given  empty: none
/// @return what was taken out, in that order. Thread-safe.
std::vector<PhotoFile> set_masks_aside(std::vector<PhotoFile>& photos,
                                       const std::filesystem::path& given);

/// What a folder of masks is to photographs.
struct MaskUse {
    std::size_t masked = 0;           ///< photographs that have one
    std::vector<std::string> unused;  ///< files that are no photograph's, ascending
};
/// @param masks  their folder @param photos  in that of the photographs; without a path: known by
/// name
/// @errors kNotFound (no such folder)
Result<MaskUse> match_masks(const std::filesystem::path& masks,
                            const std::vector<PhotoFile>& photos);

}  // namespace psfm
