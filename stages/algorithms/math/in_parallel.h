// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <cstddef>

namespace psfm {

/// body(0) ... body(count - 1), with TBB's threads where they are free. A thread that waits for the
/// others does not begin another solve in the middle of this one.
template <typename Body>
void in_parallel(std::size_t count, const Body& body) {
    tbb::this_task_arena::isolate([&] { tbb::parallel_for(std::size_t{0}, count, body); });
}

/// The same for bodies that are over in no time: `grain` of them are one task.
template <typename Body>
void in_parallel(std::size_t count, std::size_t grain, const Body& body) {
    using Range = tbb::blocked_range<std::size_t>;
    tbb::this_task_arena::isolate([&] {
        tbb::parallel_for(Range(0, count, grain), [&](const Range& range) {
            for (std::size_t i = range.begin(); i < range.end(); ++i) body(i);
        });
    });
}

}  // namespace psfm
