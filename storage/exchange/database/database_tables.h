// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to storage/exchange: the tables of a COLMAP database that are read as a whole.

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "graph/camera.h"
#include "graph/result.h"
#include "storage/exchange/database/colmap_database.h"
#include "storage/exchange/files/sqlite_statement.h"

namespace psfm::colmap {

/// Calls `use`, a Result<void>(const SqliteStatement&), for every row of a query.
template <typename Use>
Result<void> for_each_row(SqliteConnection& database, const std::string& sql, const Use& use) {
    auto statement = database.prepare(sql);
    if (!statement.ok()) return statement.error();
    while (true) {
        const auto row = statement->step();
        if (!row.ok()) return row.error();
        if (!*row) return {};
        if (auto used = use(*statement); !used.ok()) return used.error();
    }
}

/// Every table and column that psfm reads is there. Views, virtual tables and computed columns,
/// which could run anything, count as missing. @errors kDamaged
Result<void> check_tables(SqliteConnection& database);

/// By id. @errors kDamaged, kInvalidArgument (a model that psfm does not have)
Result<std::map<std::uint32_t, Camera>> read_cameras(SqliteConnection& database);

/// Ascending by name, which are unique. @param cameras  that images may name @errors kDamaged
Result<std::vector<DatabaseImage>> read_images(SqliteConnection& database,
                                               const std::map<std::uint32_t, Camera>& cameras);

}  // namespace psfm::colmap
