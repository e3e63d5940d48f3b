// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// Image headers: formats, sizes and where the EXIF data lie.
#include "stages/features/photographs/photo_container.h"
#include "tests/fuzz/fuzz_input.h"

namespace psfm {

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::span bytes(data, size);
    const auto format = identify_format(bytes);
    if (!format) return 0;
    const PhotoContainer container = parse_container(*format, bytes);
    const bool is_inside =
        container.exif.empty() || (container.exif.data() >= data &&
                                   container.exif.data() + container.exif.size() <= data + size);
    fuzz::require(is_inside, "EXIF data lie within the file");
    return 0;
}

}  // namespace psfm
