// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "stages/algorithms/matching/match_descriptors.h"

namespace psfm {

/// nearest_descriptors() on the threads of the caller's TBB arena, for many rows. While it waits,
/// the calling thread takes up no task from outside. REQUIRES: others.rows > 0. Same result for
/// every number of threads. Thread-safe.
std::vector<std::uint32_t> nearest_rows(std::span<const std::uint8_t> rows,
                                        const PackedDescriptors& others);

}  // namespace psfm
