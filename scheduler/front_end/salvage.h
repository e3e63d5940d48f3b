// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <vector>

#include "graph/image.h"
#include "storage/session/session_store.h"

namespace psfm {

/// A damaged session whose intact records are taken over into a new one.
struct Salvage {
    const SessionReader* session = nullptr;  ///< outlives the run
    std::vector<Image> images;               ///< whose records are intact, ascending by id

    // What became of them.
    std::atomic<std::uint32_t> images_taken_over{0};
    std::atomic<std::uint32_t> images_extracted{0};
    std::atomic<std::uint32_t> pair_lists_taken_over{0};
    std::atomic<std::uint32_t> pair_lists_verified{0};  ///< all of it, or some of its pairs
    /// Images with the features that they had: their ids there, by their ids in the new session.
    /// Those of an earlier run, too. To be read after the run.
    std::map<ImageId, ImageId> taken_over;
};

}  // namespace psfm
