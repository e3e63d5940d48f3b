// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/matching/nearest_rows.h"

#include <algorithm>

#include "stages/algorithms/matching/nearest_descriptors.h"
#include "stages/algorithms/math/in_parallel.h"

namespace psfm {

std::vector<std::uint32_t> nearest_rows(std::span<const std::uint8_t> rows,
                                        const PackedDescriptors& others) {
    constexpr std::size_t kSize = Descriptors::kSize;
    constexpr std::size_t kBlockRows =
        4096;  // Guard: half a megabyte: a block and its results fit the L2 cache
    const std::size_t count = rows.size() / kSize;
    if (count <= kBlockRows) return nearest_descriptors(rows, others);
    std::vector<std::uint32_t> nearest(count);
    in_parallel((count + kBlockRows - 1) / kBlockRows, [&](std::size_t block) {
        const std::size_t begin = block * kBlockRows;
        const std::size_t end = std::min(begin + kBlockRows, count);
        const auto part =
            nearest_descriptors(rows.subspan(begin * kSize, (end - begin) * kSize), others);
        std::ranges::copy(part, nearest.begin() + static_cast<std::ptrdiff_t>(begin));
    });
    return nearest;
}

}  // namespace psfm
