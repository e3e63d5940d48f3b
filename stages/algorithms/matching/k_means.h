// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "graph/image.h"

namespace psfm {

/// Lloyd's k-means on descriptors, in integers throughout: distances are exact, centres are means
/// rounded to bytes, so the result is the same bits on every processor and for every number of
/// threads. (FLANN's k-means draws from std::random_device and std::rand, and can be made neither
/// repeatable nor thread-safe: docs/retrieval.md.)
/// @param rows        descriptors of Descriptors::kSize bytes, one after another; at most 2^24 of
/// them
/// @param clusters    centres wanted; fewer come back when there are fewer rows, or when centres
/// end empty
/// @param iterations  at most; stops when no row changes its centre. More: slightly tighter cells.
/// @param seed        picks the rows that the centres start from
/// @return centres; every one is the nearest of at least one row. Empty when rows or clusters are.
/// Deterministic. Thread-safe; uses the threads of the caller's TBB arena.
Descriptors k_means(std::span<const std::uint8_t> rows, std::size_t clusters, unsigned iterations,
                    std::uint64_t seed);

}  // namespace psfm
