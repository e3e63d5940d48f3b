// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/exchange/files/locked_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "storage/exchange/files/output_file.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;

/// Makes a folder and those above it. @param made  takes up what was not there
/// REQUIRES: LockedFolder::check(folder)
Result<void> make_folders(const fs::path& folder, std::vector<fs::path>& made) {
    std::error_code failure;
    if (folder.empty() || fs::is_directory(folder, failure)) return {};
    if (auto above = make_folders(folder.parent_path(), made); !above.ok()) return above.error();
    if (fs::create_directory(folder, failure)) made.push_back(folder);
    if (failure) return file_error(folder, failure.value());
    return {};
}

}  // namespace

Result<void> LockedFolder::check(const fs::path& folder) {
    std::error_code unknown;
    if (folder.empty() || fs::is_directory(folder, unknown)) return {};
    if (fs::exists(folder, unknown)) {
        return Error{ErrorCode::kInvalidArgument,
                     folder.string() + " is a file: choose another output folder"};
    }
    if (fs::is_symlink(folder, unknown)) {
        return Error{ErrorCode::kInvalidArgument,
                     folder.string() + " is a link to " +
                         fs::read_symlink(folder, unknown).string() +
                         ", which is not there: make that folder, or choose another output folder"};
    }
    return check(folder.parent_path());
}

Result<LockedFolder> LockedFolder::take(const fs::path& folder) {
    LockedFolder locked;
    if (auto possible = check(folder); !possible.ok()) return possible.error();
    if (auto made = make_folders(folder, locked.made_); !made.ok()) return made.error();
    const fs::path path = folder.empty() ? fs::path(".") : folder;
    locked.descriptor_ = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (locked.descriptor_ < 0) return file_error(path, errno);
    while (::flock(locked.descriptor_, LOCK_EX | LOCK_NB) != 0) {
        if (errno == EINTR) continue;
        if (errno != EWOULDBLOCK) break;  // Expected: a file system without locks does without
        return Error{ErrorCode::kInUse, path.string() +
                                            " is being written by another psfm: wait until it has "
                                            "ended, or choose another output folder"};
    }
    return locked;
}

LockedFolder::LockedFolder(LockedFolder&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)), made_(std::exchange(other.made_, {})) {}

LockedFolder& LockedFolder::operator=(LockedFolder&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    std::swap(made_, other.made_);
    return *this;
}

LockedFolder::~LockedFolder() {
    std::error_code ignored;
    // Only empty ones go: removal of others fails.
    for (; !made_.empty(); made_.pop_back()) fs::remove(made_.back(), ignored);
    if (descriptor_ >= 0) ::close(descriptor_);
}

}  // namespace psfm
