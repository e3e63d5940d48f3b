// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>

#include "storage/session/session_store.h"

namespace rocksdb {
class Env;
}

// Internal: opening a session with parts replaced, for tests of faults.

namespace psfm {

struct StoreSeams {
    rocksdb::Env* env =
        nullptr;  ///< the database's files; nullptr: the file system. Outlives the store
};

enum class OpenMode { kOpenOrCreate, kExistingOnly };

/// As SessionStore::open and open_existing.
Result<std::unique_ptr<SessionStore>> open_session_store(const std::filesystem::path& folder,
                                                         const StoreOptions& options, OpenMode mode,
                                                         const StoreSeams& seams);

}  // namespace psfm
