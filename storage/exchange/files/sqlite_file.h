// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to storage/exchange: what is known of a SQLite file without SQLite.

#include <filesystem>
#include <string>

#include "graph/result.h"

namespace psfm {

struct SqliteFileLook {
    /// The file is in write-ahead mode and nobody has written since it was last closed: it can be
    /// read as it lies. SQLite would otherwise make two files beside it, which readers cannot
    /// remove, and which a read-only folder does not allow.
    bool lies_still = false;
};

/// Looks at the header (SQLite's file format, section 1.3) and at what lies beside the file.
/// @errors kNotFound, kUnreadable (no file, no permission, no SQLite file), kDamaged (ends early)
Result<SqliteFileLook> look_at_sqlite_file(const std::filesystem::path& file);

/// The path as SQLite's URI, every character of it taken literally.
std::string sqlite_uri(const std::filesystem::path& file, bool lies_still);

Error not_a_database(const std::filesystem::path& file);
/// kDamaged. @param problem  what is wrong, in words
Error damaged_database(const std::filesystem::path& file, const std::string& problem);

}  // namespace psfm
