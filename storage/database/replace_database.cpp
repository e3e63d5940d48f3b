// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/database/replace_database.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>

#include "storage/database/file_lock.h"
#include "storage/database/session_folder.h"
#include "storage/database/system_error.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;

Result<void> sync_folder(const fs::path& folder) {
    const FileHandle handle(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (!handle.is_open() || ::fsync(handle.get()) != 0)
        return system_error("cannot write " + quoted(folder), errno);
    return {};
}

/// A rename that is on the disk for good.
Result<void> move(const fs::path& from, const fs::path& to) {
    std::error_code error;
    fs::rename(from, to, error);
    if (error)
        return system_error("cannot move " + quoted(from) + " to " + quoted(to), error.value());
    // The new place first: what a power cut leaves under both names is not lost.
    if (auto synced = sync_folder(to.parent_path()); !synced.ok()) return synced.error();
    return sync_folder(from.parent_path());
}

}  // namespace

bool is_replacing(const fs::path& repaired) {
    std::error_code unknown;
    return fs::exists(repaired / kReplacedDatabaseFolder, unknown);
}

Result<void> replace_database(const fs::path& session, const fs::path& repaired,
                              const fs::path& damaged) {
    const fs::path place = session / kDatabaseFolder;
    const fs::path fresh = repaired / kDatabaseFolder;
    if (!is_replacing(repaired)) {
        // It may be the marker that is damaged.
        if (const auto marked = write_session_marker(session); !marked.ok()) return marked.error();
        const auto moved = move(place, repaired / kReplacedDatabaseFolder);
        if (!moved.ok()) return moved.error();
    }
    std::error_code none;
    if (fs::exists(fresh, none)) {
        // RocksDB leaves a lock file where it has looked for a database in vain. A folder with
        // anything else stays, and the rename fails.
        fs::remove(place / "LOCK", none);
        if (const auto moved = move(fresh, place); !moved.ok()) return moved.error();
    }
    if (const auto moved = move(repaired, damaged); !moved.ok()) return moved.error();
    return move(damaged / kReplacedDatabaseFolder, damaged / kDatabaseFolder);
}

}  // namespace psfm
