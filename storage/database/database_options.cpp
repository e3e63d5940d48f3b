// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/database/database_options.h"

#include <rocksdb/cache.h>
#include <rocksdb/convenience.h>
#include <rocksdb/env.h>
#include <rocksdb/table.h>
#include <rocksdb/write_buffer_manager.h>

#include <algorithm>
#include <cstdarg>

#include "storage/database/table_structure.h"
#include "storage/records/record_key.h"

namespace psfm {
namespace {

constexpr std::size_t kMiB = std::size_t{1} << 20U;  // Mathematics: bytes of a MiB

/// Families of large values that do not compress and are cached decoded, not as blocks.
bool is_bulk(Family family) {
    return family == Family::kKeypoints || family == Family::kDescriptors ||
           family == Family::kPoints;
}

/// RocksDB's own log says nothing that its statuses do not, and on a full disk an assertion in its
/// writer (7.8) ends the process.
class NoLog final : public rocksdb::Logger {
  public:
    using rocksdb::Logger::Logv;
    void Logv(const char* /*format*/, std::va_list /*arguments*/) override {}
};

rocksdb::ColumnFamilyOptions family_options(Family family,
                                            const std::shared_ptr<rocksdb::Cache>& cache) {
    rocksdb::BlockBasedTableOptions table;
    table.block_cache = cache;
    table.cache_index_and_filter_blocks = true;
    table.format_version = kTableFormatVersion;
    table.checksum = rocksdb::kXXH3;
    // Scene versions resemble each other, so large blocks of them compress well.
    table.block_size = family == Family::kScenes ? std::size_t{64} << 10U : std::size_t{16} << 10U;

    rocksdb::ColumnFamilyOptions options;
    options.table_factory.reset(rocksdb::NewBlockBasedTableFactory(table));
    options.write_buffer_size = is_bulk(family) ? 16 * kMiB : 4 * kMiB;
    options.max_write_buffer_number = 2;
    options.target_file_size_base = 32 * kMiB;
    options.enable_blob_files = false;  // secondary instances crash with them (docs/parts.md)
    options.compression = rocksdb::kNoCompression;
    const std::vector<rocksdb::CompressionType> supported = rocksdb::GetSupportedCompressions();
    if (!is_bulk(family) &&
        std::ranges::find(supported, rocksdb::kLZ4Compression) != supported.end()) {
        options.compression = rocksdb::kLZ4Compression;
    }
    return options;
}

/// The smaller part: blocks are in the system's own cache of files, too. Ours, tuned on the memory
/// of half an hour of photographs (docs/reliability.md): with a half it took longer to fill.
std::size_t cache_bytes_of_rocksdb(const StoreOptions& options) {
    return options.cache_bytes / 8 * 3;
}

}  // namespace

std::size_t decoded_cache_bytes(const StoreOptions& options) {
    return options.cache_bytes - cache_bytes_of_rocksdb(options);
}

DatabaseOptions make_database_options(const StoreOptions& options, rocksdb::Env* env) {
    const std::size_t cache_bytes = std::max(cache_bytes_of_rocksdb(options), 8 * kMiB);
    const auto cache = rocksdb::NewLRUCache(cache_bytes);

    DatabaseOptions result;
    rocksdb::DBOptions& database = result.database;
    if (env != nullptr) database.env = env;
    database.paranoid_checks = true;
    // Damage inside the log is an error; the default would cut off acknowledged commits in silence.
    database.wal_recovery_mode = rocksdb::WALRecoveryMode::kTolerateCorruptedTailRecords;
    database.write_buffer_manager =
        std::make_shared<rocksdb::WriteBufferManager>(cache_bytes / 2, cache);
    database.max_total_wal_size = 64 * kMiB;
    database.max_background_jobs = 2;
    database.max_open_files = -1;  // a secondary keeps reading files that the writer deletes
    // The default, 16 for every family, starts 650 threads to open a session for reading.
    database.max_file_opening_threads = 1;
    database.max_manifest_file_size = 16 * kMiB;
    database.info_log = std::make_shared<NoLog>();
    database.stats_dump_period_sec = 0;
    database.stats_persist_period_sec = 0;
    database.bytes_per_sync = kMiB;

    result.families.emplace_back(rocksdb::kDefaultColumnFamilyName,
                                 family_options(Family::kMeta, cache));
    for (const Family family : kFamilies) {
        result.families.emplace_back(name_of(family), family_options(family, cache));
    }
    return result;
}

}  // namespace psfm
