// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// COLMAP's models as text. An input is cameras.txt, images.txt and points3D.txt, with a line of
// three dashes between them.
#include "tests/fuzz/colmap_model.h"

namespace psfm {

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const fuzz::InputFolder folder;
    constexpr std::string_view kBetween = "---\n";
    std::array<std::span<const std::uint8_t>, 3> parts;
    std::span<const std::uint8_t> rest(data, size);
    for (auto& part : parts) {
        const std::size_t end = fuzz::as_text(rest).find(kBetween);
        part = rest.first(std::min(end, rest.size()));
        rest = rest.subspan(std::min(part.size() + kBetween.size(), rest.size()));
    }
    fuzz::read_model(folder, {parts[0], parts[1], parts[2]}, ".txt");
    return 0;
}

}  // namespace psfm
