// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/console/mask_report.h"

#include <iostream>

#include "graph/wording.h"
#include "stages/features/photographs/masks_beside_photos.h"

namespace psfm {
namespace {

constexpr const char* kMaskNames =
    "; the mask of a.jpg is a.jpg.png, a_mask.png or a.png, in the same sub-folder\n";

}  // namespace

Result<void> tell_of_masks(const std::string& masks, const std::vector<PhotoFile>& photos) {
    const auto use = match_masks(masks, photos);
    if (!use.ok()) return use.error();
    if (!use->unused.empty()) {
        std::cerr << "psfm: MASKS WITHOUT A PHOTOGRAPH in " << masks << ": " << some_of(use->unused)
                  << kMaskNames;
    }
    if (use->masked == 0) std::cerr << "psfm: no photograph has a mask in " << masks << kMaskNames;
    return {};
}

}  // namespace psfm
