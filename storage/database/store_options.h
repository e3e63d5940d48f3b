// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

namespace psfm {

/// How much of every scene version is kept.
enum class History : std::uint8_t { kNone = 0, kPoses = 1, kFull = 2 };

struct StoreOptions {
    /// Block cache and write buffers together [bytes]. Lower: more reads from disk; higher: more
    /// memory. Ours: descriptors of about 250 images of 8,000 features.
    std::size_t cache_bytes = std::size_t{256} << 20U;
    History history = History::kPoses;
};

}  // namespace psfm
