// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace psfm {

/// A loop's body over part of its range. Behind a pointer, so that TBB is compiled once.
using RangeBody = void (*)(const void* body, std::size_t begin, std::size_t end);

/// run(body, ...) for the parts of [0, count), each of `grain` and more.
void ranges_in_parallel(std::size_t count, std::size_t grain, RangeBody run, const void* body);

/// body(0) ... body(count - 1), with TBB's threads where they are free. A thread that waits for the
/// others does not begin another solve in the middle of this one.
/// @param grain  of bodies that are over in no time: so many are one task
template <typename Body>
void in_parallel(std::size_t count, std::size_t grain, const Body& body) {
    const RangeBody run = [](const void* each, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) (*static_cast<const Body*>(each))(i);
    };
    ranges_in_parallel(count, grain, run, &body);
}

template <typename Body>
void in_parallel(std::size_t count, const Body& body) {
    in_parallel(count, 1, body);
}

}  // namespace psfm
