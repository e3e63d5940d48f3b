// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "storage/database/file_lock.h"
#include "storage/database/session_folder.h"
#include "storage/database/system_error.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxReaders = 100'000;  // Guard: ends the search for a free name

FileHandle open_folder(const fs::path& path) {
    return FileHandle(::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
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

Error too_many(const fs::path& parent) {
    return {ErrorCode::kIo, "too many readers in " + quoted(parent)};
}

/// Whether the reader may read the session and write nothing into it.
bool is_read_only(int error_number) {
    return error_number == EACCES || error_number == EROFS || error_number == EPERM;
}

/// Removes the folders whose names begin so and that nobody holds. Failures are left for next time.
void remove_abandoned(const fs::path& parent, std::string_view beginning) {
    std::error_code ignored;
    std::vector<fs::path> folders;
    for (fs::directory_iterator entry(parent, ignored), end; !ignored && entry != end;
         entry.increment(ignored)) {
        if (entry->path().filename().string().starts_with(beginning))
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

}  // namespace

Result<std::optional<ReaderFolder>> ReaderFolder::hold(const fs::path& path) {
    FileHandle handle = open_folder(path);
    if (!handle.is_open()) return std::optional<ReaderFolder>();
    const auto locked = handle.try_lock(FileHandle::LockMode::kExclusive, path);
    if (!locked.ok()) return locked.error();
    if (!*locked || !still_there(path, handle)) return std::optional<ReaderFolder>();
    return std::optional<ReaderFolder>(ReaderFolder(path, std::move(handle)));
}

Result<ReaderFolder> ReaderFolder::make_temporary() {
    constexpr const char* kBeginning = "psfm-reader-";
    std::error_code failure;
    fs::path parent = fs::temp_directory_path(failure);
    if (failure) parent = "/tmp";
    remove_abandoned(parent, kBeginning);
    for (int n = 0; n < kMaxReaders; ++n) {
        std::string name = (parent / kBeginning).string() + "XXXXXX";
        if (::mkdtemp(name.data()) == nullptr) {
            return Error{ErrorCode::kIo,
                         "cannot make a folder in " + quoted(parent) +
                             ", which reading a session without writing into it takes: " +
                             std::generic_category().message(errno) +
                             "; name a folder that can be written: TMPDIR=FOLDER psfm …"};
        }
        auto held = hold(name);
        if (!held.ok()) return held.error();
        if (*held) return **std::move(held);
    }
    return too_many(parent);
}

Result<ReaderFolder> ReaderFolder::make(const fs::path& session) {
    const fs::path parent = session / kReadersFolder;
    const auto elsewhere = [&](const fs::path& path) -> Result<ReaderFolder> {
        if (!is_read_only(errno)) return cannot_make(path);
        return make_temporary();
    };
    if (::mkdir(parent.c_str(), 0755) != 0 && errno != EEXIST) return elsewhere(parent);
    for (int n = 0; n < kMaxReaders; ++n) {
        const fs::path path = parent / (std::to_string(getpid()) + "-" + std::to_string(n));
        if (::mkdir(path.c_str(), 0755) != 0) {
            if (errno == EEXIST) continue;
            return elsewhere(path);
        }
        auto held = hold(path);
        if (!held.ok()) return held.error();
        if (*held) return **std::move(held);
    }
    return too_many(parent);
}

ReaderFolder::~ReaderFolder() {
    if (!lock_.is_open()) return;
    std::error_code ignored;
    fs::remove_all(path_, ignored);
}

void remove_stale_reader_folders(const fs::path& session) {
    remove_abandoned(session / kReadersFolder, "");
}

}  // namespace psfm
