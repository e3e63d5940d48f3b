// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/database/system_error.h"

#include <rocksdb/status.h>

#include <cerrno>
#include <system_error>

namespace psfm {
namespace {

constexpr const char* kSpaceRemedy = ": the disk is full; make space, then run 'psfm resume'";

constexpr const char* kIoRemedy =
    "; what was acknowledged is stored: look after the disk, then run 'psfm resume'";

constexpr const char* kPermissionRemedy =
    "; change its permissions or its owner (chmod, chown), or run psfm as the user that it belongs "
    "to";

bool is_denial(int error_number) {
    return error_number == EACCES || error_number == EPERM;
}

/// RocksDB keeps of the system's error only the words, after the file's name.
bool is_denial(const rocksdb::Status& status) {
    const std::string words = status.ToString();
    return words.ends_with(std::generic_category().message(EACCES)) ||
           words.ends_with(std::generic_category().message(EPERM));
}

}  // namespace

Error system_error(const std::string& what, int error_number) {
    if (error_number == ENOSPC || error_number == EDQUOT) {
        return {ErrorCode::kNoSpace, what + kSpaceRemedy};
    }
    return {ErrorCode::kIo, what + ": " + std::generic_category().message(error_number) +
                                (is_denial(error_number) ? kPermissionRemedy : "")};
}

Error database_error(const std::string& where, const rocksdb::Status& status) {
    if (status.IsNoSpace()) return {ErrorCode::kNoSpace, where + kSpaceRemedy};
    if (is_denial(status))
        return {ErrorCode::kIo, where + ": " + status.ToString() + kPermissionRemedy};
    // A file that the database names and that is gone, or that ends too early, is damage as well.
    if (status.IsCorruption() || status.IsPathNotFound() || status.IsInvalidArgument()) {
        return {ErrorCode::kDamaged, where + " is damaged: " + status.ToString() + kDamageRemedy};
    }
    return {ErrorCode::kIo, where + ": " + status.ToString() + kIoRemedy};
}

}  // namespace psfm
