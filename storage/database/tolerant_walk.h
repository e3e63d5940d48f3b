// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "storage/database/read_view.h"

// Internal: going through a column family whose tables may be damaged.

namespace psfm {

struct WalkCallbacks {
    std::function<void(std::string_view key, std::string_view value)> record;
    /// A gap that cannot be read. @param after, before  the readable keys around it; empty: none
    std::function<void(const std::string& after, const std::string& before,
                       const std::string& problem)>
        gap;
};

/// Visits every readable record in order of keys, and steps over blocks that fail their checksum.
void walk_family(const ReadView& view, Family family, const WalkCallbacks& callbacks);

}  // namespace psfm
