// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace psfm {

/// One damaged record found by `check`.
struct DamagedRecord {
    std::string kind;
    std::string key;
    std::string problem;
};

/// What `check` saw.
struct CheckReport {
    std::vector<std::pair<std::string, std::uint64_t>> records;  ///< kind, count
    std::vector<DamagedRecord> damaged;
};

}  // namespace psfm
