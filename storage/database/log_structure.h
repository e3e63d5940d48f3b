// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string_view>

#include "graph/result.h"

// Internal: damage in RocksDB's logs that it takes for their end.

namespace psfm {

/// Whether bytes in RocksDB's log format (its write-ahead logs and its MANIFEST) are damaged before
/// their end. A log that a crash has cut off ends within its last batch; RocksDB (7.8) takes a
/// damaged length for such an end as well, forgets what follows in silence, and dies of an
/// assertion at some types of record. Here it is damage when a batch begins behind what cannot be
/// read, since batches are synced one by one, or when a record is of no type.
bool is_damaged_inside(std::string_view log);

/// The logs that a database is opened from. REQUIRES: nobody writes to it
/// @errors kDamaged
Result<void> check_logs(const std::filesystem::path& session);

}  // namespace psfm
