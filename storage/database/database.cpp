// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/database/database.h"

#include <algorithm>
#include <chrono>
#include <mutex>
#include <thread>

#include "storage/database/database_options.h"
#include "storage/database/log_structure.h"
#include "storage/database/session_folder.h"
#include "storage/database/system_error.h"
#include "storage/database/table_structure.h"

namespace psfm {
namespace {

/// Tables without the file that names them: making a database there would delete them.
bool has_orphaned_tables(const std::filesystem::path& folder) {
    std::error_code error;
    if (std::filesystem::exists(folder / "CURRENT", error)) return false;
    for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end;
         entry.increment(error)) {
        if (entry->path().extension() == ".sst") return true;
    }
    return false;
}

/// Whether the database can be opened as its writer would, every table and the whole log. A
/// secondary instance does not say: it falls back on the last state whose tables it can read.
/// Writers are kept out meanwhile; beside one there is nothing to do, as it looked when it opened.
Result<void> look_through(const std::filesystem::path& session, const StoreOptions& options) {
    if (auto sound = check_logs(session); !sound.ok()) return sound.error();
    if (auto sound = check_tables(session); !sound.ok()) return sound.error();
    const DatabaseOptions setup = make_database_options(options, nullptr);
    rocksdb::DB* db = nullptr;
    std::vector<rocksdb::ColumnFamilyHandle*> handles;
    const rocksdb::Status status = rocksdb::DB::OpenForReadOnly(
        setup.database, (session / kDatabaseFolder).string(), setup.families, &handles, &db);
    if (!status.ok()) return database_error(session_label(session), status);
    const std::unique_ptr<rocksdb::DB> owner(db);
    for (rocksdb::ColumnFamilyHandle* handle : handles) {
        db->DestroyColumnFamilyHandle(handle).PermitUncheckedError();
    }
    return {};
}

}  // namespace

Result<std::unique_ptr<Database>> Database::open_primary(const std::filesystem::path& session,
                                                         SessionLock lock, DatabaseMode mode,
                                                         const StoreOptions& options,
                                                         rocksdb::Env* env) {
    const std::filesystem::path folder = session / kDatabaseFolder;
    const std::string label = session_label(session);
    if (mode == DatabaseMode::kCreate && has_orphaned_tables(folder)) {
        return Error{ErrorCode::kDamaged,
                     label + " has lost its marker and its database's index" + kDamageRemedy};
    }
    if (const auto sound = check_logs(session); !sound.ok()) return sound.error();
    if (const auto sound = check_tables(session); !sound.ok()) return sound.error();
    DatabaseOptions setup = make_database_options(options, env);
    setup.database.create_if_missing = mode == DatabaseMode::kCreate;
    setup.database.create_missing_column_families = mode == DatabaseMode::kCreate;

    std::unique_ptr<Database> database(new Database(label));
    database->lock_ = std::move(lock);
    rocksdb::DB* db = nullptr;
    std::vector<rocksdb::ColumnFamilyHandle*> handles;
    const rocksdb::Status status =
        rocksdb::DB::Open(setup.database, folder.string(), setup.families, &handles, &db);
    if (!status.ok()) return database_error(label, status);
    database->take(db, handles);
    return database;
}

Result<std::unique_ptr<Database>> Database::open_secondary(const std::filesystem::path& session,
                                                           ReaderFolder scratch,
                                                           const StoreOptions& options) {
    const std::filesystem::path folder = session / kDatabaseFolder;
    const std::string label = session_label(session);
    const DatabaseOptions setup = make_database_options(options, nullptr);
    std::unique_ptr<Database> database(new Database(label));
    database->secondary_ = true;
    database->scratch_.emplace(std::move(scratch));
    const auto quiet = SessionLock::exclude_writers(session);
    if (!quiet.ok()) return quiet.error();
    const bool beside_writer = !quiet->has_value();
    // A writer that is there has looked through everything when it opened.
    if (!beside_writer) {
        auto looked = look_through(session, options);
        if (!looked.ok()) return looked.error();
    }
    rocksdb::Status status;
    // A writer may delete a file between our reading its name and opening it: look again.
    const int attempts = beside_writer ? 10 : 1;
    for (int attempt = 0; attempt < attempts; ++attempt) {
        if (attempt > 0) std::this_thread::sleep_for(std::chrono::milliseconds(10 * attempt));
        rocksdb::DB* db = nullptr;
        std::vector<rocksdb::ColumnFamilyHandle*> handles;
        status = rocksdb::DB::OpenAsSecondary(setup.database, folder.string(),
                                              database->scratch_->path().string(), setup.families,
                                              &handles, &db);
        if (!status.ok()) continue;
        database->take(db, handles);
        return database;
    }
    return database_error(label, status);
}

void Database::take(rocksdb::DB* db, const std::vector<rocksdb::ColumnFamilyHandle*>& handles) {
    db_.reset(db);
    default_handle_ = handles.front();
    std::copy(handles.begin() + 1, handles.end(), handles_.begin());
}

Database::~Database() {
    if (!db_) return;
    if (!secondary_) {
        const std::vector<rocksdb::ColumnFamilyHandle*> all(handles_.begin(), handles_.end());
        // What cannot be flushed now is in the log, and comes back from there.
        db_->Flush(rocksdb::FlushOptions(), all).PermitUncheckedError();
    }
    for (rocksdb::ColumnFamilyHandle* handle : handles_) {
        db_->DestroyColumnFamilyHandle(handle).PermitUncheckedError();
    }
    db_->DestroyColumnFamilyHandle(default_handle_).PermitUncheckedError();
    db_->Close().PermitUncheckedError();
}

Result<void> Database::write(rocksdb::WriteBatch& batch) {
    rocksdb::WriteOptions options;
    options.sync = true;
    const rocksdb::Status status = db_->Write(options, &batch);
    if (!status.ok()) return database_error(label_, status);
    return {};
}

Result<void> Database::compact() {
    rocksdb::CompactRangeOptions options;
    options.bottommost_level_compaction = rocksdb::BottommostLevelCompaction::kForceOptimized;
    for (rocksdb::ColumnFamilyHandle* handle : handles_) {
        const rocksdb::Status status = db_->CompactRange(options, handle, nullptr, nullptr);
        if (!status.ok()) return database_error(label_, status);
    }
    return {};
}

Result<bool> Database::catch_up() const {
    if (!secondary_) return false;
    const std::unique_lock lock(view_mutex_);
    const rocksdb::SequenceNumber before = db_->GetLatestSequenceNumber();
    rocksdb::Status status;
    // Guard: a busy writer's files may vanish while they are followed; 50 ms in all.
    constexpr int kAttempts = 5;
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
        if (attempt > 0) std::this_thread::sleep_for(std::chrono::milliseconds(5 * attempt));
        status = db_->TryCatchUpWithPrimary();
        if (status.ok()) return db_->GetLatestSequenceNumber() != before;
    }
    return database_error(label_, status);
}

}  // namespace psfm
