// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/math/in_parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace psfm {

void ranges_in_parallel(std::size_t count, std::size_t grain, RangeBody run, const void* body) {
    using Blocks = tbb::blocked_range<std::size_t>;
    tbb::this_task_arena::isolate([&] {
        tbb::parallel_for(Blocks(0, count, grain),
                          [&](const Blocks& blocks) { run(body, blocks.begin(), blocks.end()); });
    });
}

}  // namespace psfm
