// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/matching/nearest_rows.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>

#include "stages/algorithms/matching/nearest_descriptors.h"

namespace psfm {

std::vector<std::uint32_t> nearest_rows(std::span<const std::uint8_t> rows,
                                        const PackedDescriptors& others) {
    constexpr std::size_t kSize = Descriptors::kSize;
    constexpr std::size_t kBlockRows =
        4096;  // Guard: half a megabyte: a block and its results fit the L2 cache
    const std::size_t count = rows.size() / kSize;
    if (count <= kBlockRows) return nearest_descriptors(rows, others);
    std::vector<std::uint32_t> nearest(count);
    tbb::this_task_arena::isolate([&] {
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, (count + kBlockRows - 1) / kBlockRows),
                          [&](const tbb::blocked_range<std::size_t>& blocks) {
                              for (std::size_t block = blocks.begin(); block != blocks.end();
                                   ++block) {
                                  const std::size_t begin = block * kBlockRows;
                                  const std::size_t end = std::min(begin + kBlockRows, count);
                                  const auto part = nearest_descriptors(
                                      rows.subspan(begin * kSize, (end - begin) * kSize), others);
                                  std::copy(part.begin(), part.end(),
                                            nearest.begin() + static_cast<std::ptrdiff_t>(begin));
                              }
                          });
    });
    return nearest;
}

}  // namespace psfm
