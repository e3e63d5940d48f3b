// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <vector>

#include "storage/database/file_lock.h"
#include "storage/database/session_folder.h"
#include "storage/database/system_error.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;

FileHandle open_folder(const fs::path& path) {
    return FileHandle(::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
}

/// Whether the path still leads to the open folder.
bool still_there(const fs::path& path, const FileHandle& handle) {
    struct stat by_path {};
    struct stat by_handle {};
    return ::stat(path.c_str(), &by_path) == 0 && ::fstat(handle.get(), &by_handle) == 0 &&
           by_path.st_ino == by_handle.st_ino && by_path.st_dev == by_handle.st_dev;
}

Error cannot_make(const fs::path& path) {
    return system_error("cannot make " + quoted(path) + " (a reader needs a folder of its own)",
                        errno);
}

/// Whether the reader may read the session and write nothing into it.
bool is_read_only(int error_number) {
    return error_number == EACCES || error_number == EROFS || error_number == EPERM;
}

/// A new folder among the temporary files. No writer looks there, so that nobody takes it away.
Result<fs::path> make_temporary() {
    std::error_code failure;
    fs::path pattern = fs::temp_directory_path(failure);
    if (failure) pattern = "/tmp";
    std::string name = (pattern / "psfm-reader-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) return cannot_make(name);
    return fs::path(name);
}

}  // namespace

Result<ReaderFolder> ReaderFolder::make(const fs::path& session) {
    const fs::path parent = session / kReadersFolder;
    const auto elsewhere = [&](const fs::path& path) -> Result<ReaderFolder> {
        if (!is_read_only(errno)) return cannot_make(path);
        auto made = make_temporary();
        if (!made.ok()) return made.error();
        return ReaderFolder(*made, open_folder(*made));
    };
    if (::mkdir(parent.c_str(), 0755) != 0 && errno != EEXIST) return elsewhere(parent);
    constexpr int kMaxReaders = 100'000;  // Guard: ends the search for a free name
    for (int n = 0; n < kMaxReaders; ++n) {
        const fs::path path = parent / (std::to_string(getpid()) + "-" + std::to_string(n));
        if (::mkdir(path.c_str(), 0755) != 0) {
            if (errno == EEXIST) continue;
            return elsewhere(path);
        }
        FileHandle handle = open_folder(path);
        if (!handle.is_open()) continue;
        // A writer that opens just now may take the folder for a stale one before the lock is on
        // it.
        const auto locked = handle.try_lock(FileHandle::LockMode::kExclusive, path);
        if (!locked.ok()) return locked.error();
        if (*locked && still_there(path, handle)) return ReaderFolder(path, std::move(handle));
    }
    return Error{ErrorCode::kIo, "too many readers in " + quoted(parent)};
}

ReaderFolder::~ReaderFolder() {
    if (!lock_.is_open()) return;
    std::error_code ignored;
    fs::remove_all(path_, ignored);
}

void remove_stale_reader_folders(const fs::path& session) {
    std::error_code ignored;
    std::vector<fs::path> folders;
    for (fs::directory_iterator entry(session / kReadersFolder, ignored), end;
         !ignored && entry != end; entry.increment(ignored)) {
        folders.push_back(entry->path());
    }
    for (const fs::path& folder : folders) {
        const FileHandle handle = open_folder(folder);
        if (!handle.is_open()) continue;
        const auto locked = handle.try_lock(FileHandle::LockMode::kExclusive, folder);
        // Expected: what cannot be locked is left there
        if (locked.ok() && *locked) fs::remove_all(folder, ignored);
    }
}

}  // namespace psfm
