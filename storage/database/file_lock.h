// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <utility>

#include "graph/result.h"

namespace psfm {

/// An open file or folder; closed at the end, which also drops its flock(2).
class FileHandle {
  public:
    FileHandle() = default;
    explicit FileHandle(int descriptor) : descriptor_(descriptor) {}
    FileHandle(FileHandle&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
    FileHandle& operator=(FileHandle&& other) noexcept {
        std::swap(descriptor_, other.descriptor_);
        return *this;
    }
    ~FileHandle();

    int get() const { return descriptor_; }
    bool is_open() const { return descriptor_ >= 0; }
    enum class LockMode { kShared, kExclusive };
    /// Takes the lock without waiting. @return false when another holder is in the way
    Result<bool> try_lock(LockMode mode, const std::filesystem::path& path_for_messages) const;

  private:
    int descriptor_ = -1;
};

/// The one writer of a session (FORMAT.md section 1). Held as long as the object lives; the kernel
/// drops it when the process dies.
class SessionLock {
  public:
    /// REQUIRES: the folder exists. @errors kInUse (names the holder's pid), kNoSpace, kIo
    static Result<SessionLock> acquire(const std::filesystem::path& folder);

    /// Keeps writers out for a moment, while the object lives: acquire() waits 0.5 s for that.
    /// Readers do not exclude each other. Nothing when there is a writer. @errors kIo
    static Result<std::optional<SessionLock>> exclude_writers(const std::filesystem::path& folder);

  private:
    explicit SessionLock(FileHandle file) : file_(std::move(file)) {}
    FileHandle file_;
};

/// A reader's own folder beside the writer: SESSION/secondary/PID-N, or one among the temporary
/// files where the reader may not write into the session. Held by a flock(2) and removed at the
/// end; what a reader that was killed left, the next writer or reader there removes.
class ReaderFolder {
  public:
    /// @errors kNoSpace, kIo
    static Result<ReaderFolder> make(const std::filesystem::path& session);
    ReaderFolder(ReaderFolder&&) noexcept = default;
    ReaderFolder& operator=(ReaderFolder&&) = delete;
    ~ReaderFolder();

    const std::filesystem::path& path() const { return path_; }

  private:
    static Result<ReaderFolder> make_temporary();
    /// One that was just made. Nothing where somebody took it for an abandoned one before that.
    static Result<std::optional<ReaderFolder>> hold(const std::filesystem::path& path);
    ReaderFolder(std::filesystem::path path, FileHandle lock)
        : path_(std::move(path)), lock_(std::move(lock)) {}
    std::filesystem::path path_;
    FileHandle lock_;
};

/// Removes the folders of readers that are gone; those in use stay. Failures are left for next
/// time.
void remove_stale_reader_folders(const std::filesystem::path& session);

}  // namespace psfm
