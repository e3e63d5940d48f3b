// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rocksdb/db.h>

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <shared_mutex>
#include <string>
#include <vector>

#include "graph/result.h"
#include "storage/database/file_lock.h"
#include "storage/database/store_options.h"
#include "storage/records/record_key.h"

// Internal: the RocksDB database of a session.

namespace psfm {

enum class DatabaseMode {
    kCreate,    ///< write; made when it is not there
    kExisting,  ///< write; must be there
};

/// An open database. Thread-safe, apart from write().
class Database {
  public:
    /// @param lock  held until the database is closed
    /// @param env  where files come from; nullptr: the file system
    /// @errors kDamaged, kNoSpace, kIo
    static Result<std::unique_ptr<Database>> open_primary(const std::filesystem::path& session,
                                                          SessionLock lock, DatabaseMode mode,
                                                          const StoreOptions& options,
                                                          rocksdb::Env* env);
    /// Reads beside a writer. @param scratch  kept until the database is closed
    /// @errors kDamaged, kNoSpace, kIo
    static Result<std::unique_ptr<Database>> open_secondary(const std::filesystem::path& session,
                                                            ReaderFolder scratch,
                                                            const StoreOptions& options);
    Database(const Database&) = delete;
    Database& operator=(const Database&) = delete;
    /// A writer empties its write-ahead log into tables first, so that the next opening is quick.
    ~Database();

    /// One atomic, synced write. @errors kNoSpace, kIo, kDamaged
    Result<void> write(rocksdb::WriteBatch& batch);
    /// Rewrites all tables without what was replaced or deleted. @errors kNoSpace, kIo, kDamaged
    Result<void> compact();
    /// Secondary: follows the writer. Primary: does nothing. @return whether there was anything new
    Result<bool> catch_up() const;

    bool is_secondary() const { return secondary_; }
    rocksdb::DB& db() const { return *db_; }
    rocksdb::ColumnFamilyHandle* family(Family family) const {
        return handles_[static_cast<std::size_t>(family)];
    }
    /// Keeps a secondary's view from moving; readers share it.
    std::shared_mutex& view_mutex() const { return view_mutex_; }
    const std::string& label() const { return label_; }

  private:
    explicit Database(std::string label) : label_(std::move(label)) {}
    void take(rocksdb::DB* db, const std::vector<rocksdb::ColumnFamilyHandle*>& handles);

    std::string label_;
    bool secondary_ = false;
    // Before db_, so that they go after it.
    std::optional<SessionLock> lock_;
    std::optional<ReaderFolder> scratch_;
    std::unique_ptr<rocksdb::DB> db_;
    std::array<rocksdb::ColumnFamilyHandle*, kFamilies.size()> handles_{};
    rocksdb::ColumnFamilyHandle* default_handle_ = nullptr;
    mutable std::shared_mutex view_mutex_;
};

}  // namespace psfm
