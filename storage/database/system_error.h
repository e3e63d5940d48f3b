// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "graph/result.h"

namespace rocksdb {
class Status;
}

namespace psfm {

/// Error of the operating system. @param what  "cannot write '/a/b'"
/// @return kNoSpace for a full disk or quota, else kIo; where permission is lacking, the remedy too
Error system_error(const std::string& what, int error_number);

/// Error of RocksDB. @param where  "session '/a'" or "session '/a', images, image 7"
/// @return kDamaged, kNoSpace or kIo. REQUIRES: !status.ok()
Error database_error(const std::string& where, const rocksdb::Status& status);

/// Appended to messages about damage: what a person can do.
inline constexpr const char* kDamageRemedy =
    "; 'psfm check' lists all damage, 'psfm repair' recomputes what it can";

}  // namespace psfm
