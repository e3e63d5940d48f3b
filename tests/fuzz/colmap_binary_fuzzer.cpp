// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// COLMAP's binary models. An input is the sizes of cameras.bin and images.bin (two bytes each, the
// lower first), and then the three files.
#include "tests/fuzz/colmap_model.h"

namespace psfm {

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const fuzz::InputFolder folder;
    if (size < 4) return 0;
    const std::span<const std::uint8_t> files(data + 4, size - 4);
    const auto first = std::min<std::size_t>(data[0] + 256U * data[1], files.size());
    const auto second = std::min<std::size_t>(data[2] + 256U * data[3], files.size() - first);
    fuzz::read_model(
        folder, {files.first(first), files.subspan(first, second), files.subspan(first + second)},
        ".bin");
    return 0;
}

}  // namespace psfm
