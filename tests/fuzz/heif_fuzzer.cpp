// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// HEIF files, which libheif takes apart; the limit on pixels as in photo_fuzzer.cpp.
#include "stages/features/photographs/decode_heif.h"
#include "stages/features/photographs/read_exif.h"
#include "tests/fuzz/fuzz_input.h"

namespace psfm {

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (identify_format({data, size}) != PhotoFormat::kHeif) return 0;
    const auto photo = decode_heif({data, size}, 250'000.0);
    if (!photo) return 0;
    fuzz::require(photo->colour.type() == CV_8UC3 && !photo->colour.empty(),
                  "photographs are 8-bit BGR");
    fuzz::require(photo->colour.total() <= 250'000, "the limit on pixels holds");
    (void)read_exif(photo->exif);
    return 0;
}

}  // namespace psfm
