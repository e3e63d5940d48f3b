// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rocksdb/db.h>

#include <vector>

#include "storage/database/store_options.h"

// Internal: how RocksDB is set up. Not persistent: tables say themselves how they were written.

namespace psfm {

/// Database options and the column families, `default` first, then kFamilies in order.
struct DatabaseOptions {
    rocksdb::DBOptions database;
    std::vector<rocksdb::ColumnFamilyDescriptor> families;
};

/// One cache for everything: blocks, and the write buffers charged to it.
DatabaseOptions make_database_options(const StoreOptions& options, rocksdb::Env* env);

/// Part of StoreOptions::cache_bytes for values that are decoded already; the rest is RocksDB's.
std::size_t decoded_cache_bytes(const StoreOptions& options);

}  // namespace psfm
