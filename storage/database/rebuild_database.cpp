// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/database/rebuild_database.h"

#include <memory>
#include <string>
#include <vector>

#include "storage/database/database_options.h"
#include "storage/database/session_folder.h"
#include "storage/database/system_error.h"
#include "storage/database/table_structure.h"

namespace psfm {

Result<void> rebuild_database(const std::filesystem::path& session,
                              const std::filesystem::path& copy) {
    std::error_code error;
    std::filesystem::remove_all(copy, error);
    std::filesystem::create_directories(copy, error);
    if (!error) {
        std::filesystem::copy(session / kDatabaseFolder, copy / kDatabaseFolder,
                              std::filesystem::copy_options::recursive, error);
    }
    if (error) return system_error("cannot copy the database to " + quoted(copy), error.value());
    // RocksDB would die of them; what it cannot read is left out likewise.
    for (const std::filesystem::path& table : damaged_tables(copy / kDatabaseFolder))
        std::filesystem::remove(table, error);
    DatabaseOptions setup = make_database_options({}, nullptr);
    const std::string folder = (copy / kDatabaseFolder).string();
    rocksdb::Status status = rocksdb::RepairDB(folder, setup.database, setup.families);
    if (!status.ok()) return database_error(session_label(session), status);
    // Families none of whose tables could be read are empty, not missing.
    setup.database.create_missing_column_families = true;
    rocksdb::DB* opened = nullptr;
    std::vector<rocksdb::ColumnFamilyHandle*> handles;
    status = rocksdb::DB::Open(setup.database, folder, setup.families, &handles, &opened);
    if (!status.ok()) return database_error(session_label(session), status);
    const std::unique_ptr<rocksdb::DB> database(opened);
    for (rocksdb::ColumnFamilyHandle* handle : handles)
        database->DestroyColumnFamilyHandle(handle).PermitUncheckedError();
    return write_session_marker(copy);
}

}  // namespace psfm
