// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "graph/result.h"

// Internal: damage in RocksDB's tables that it does not find before it trips over it.

namespace psfm {

/// Format: of RocksDB's block-based tables, the version that psfm writes with every library:
/// RocksDB 9 would write version 6, which neither RocksDB 7.8 nor the check below can read.
inline constexpr std::uint32_t kTableFormatVersion = 5;

/// Whether the properties of a table are not what their checksum says. RocksDB (7.8) takes this
/// block, and no other, apart before it compares the checksum, and dies of an assertion at some of
/// its bytes. Damage that keeps the block from being found is found by RocksDB itself; tables of
/// other formats than ours are left to it.
bool has_damaged_properties(const std::filesystem::path& table);

/// Tables of a database folder that have, in any order.
std::vector<std::filesystem::path> damaged_tables(const std::filesystem::path& folder);

/// The tables that a database is opened from. @errors kDamaged, which names the table
Result<void> check_tables(const std::filesystem::path& session);

}  // namespace psfm
