// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// EXIF data, as they lie in any container.
#include <cmath>

#include "stages/features/photographs/read_exif.h"
#include "stages/features/photographs/text.h"
#include "tests/fuzz/fuzz_input.h"

namespace psfm {

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const ExifTags tags = read_exif({data, size});
    for (const std::string& text : {tags.make, tags.model}) {
        fuzz::require(is_valid_utf8(text) && !has_control_characters(text) && text.size() <= 64,
                      "make and model are short lines of UTF-8");
    }
    for (const auto& number : {tags.focal_mm, tags.focal_35mm}) {
        fuzz::require(!number || (std::isfinite(*number) && *number > 0.0),
                      "focal lengths are positive");
    }
    fuzz::require(tags.orientation >= 1 && tags.orientation <= 8, "orientation is 1 to 8");
    if (tags.gps) {
        fuzz::require(
            std::abs(tags.gps->latitude_deg) <= 90.0 && std::abs(tags.gps->longitude_deg) <= 180.0,
            "positions are on the earth");
    }
    return 0;
}

}  // namespace psfm
