// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rocksdb/env.h>
#include <rocksdb/file_system.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>

namespace psfm::testing {

class FaultFileSystem;

/// An environment with these files, whose sleeps are short: RocksDB's background work sleeps for a
/// second after every failure.
std::unique_ptr<rocksdb::Env> make_env(std::shared_ptr<FaultFileSystem> files);

/// The file system, on a disk that can be full, fail, be read-only or lose its power. Thread-safe.
class FaultFileSystem : public rocksdb::FileSystemWrapper {
  public:
    enum class Call : std::uint8_t { kAppend, kSync, kRead };

    FaultFileSystem() : FileSystemWrapper(rocksdb::FileSystem::Default()) {}
    const char* Name() const override { return "FaultFileSystem"; }

    /// Space for new bytes; without a call there is enough.
    void set_free_bytes(std::int64_t bytes) { free_bytes_ = bytes; }
    /// No file can be written, or made, from now on.
    void set_read_only(bool read_only) { read_only_ = read_only; }
    /// The n-th such call from now fails, n >= 1, and no other; 0: none.
    void fail_once(Call call, std::int64_t n);
    /// The n-th append or sync from now fails, n >= 1, and everything after it.
    void cut_power(std::int64_t n) { until_power_cut_ = n; }
    /// What a power cut leaves: files without what was not synced. REQUIRES: no file is open
    void lose_unsynced();
    /// Calls of that kind so far.
    std::int64_t calls(Call call) const { return counts_[static_cast<std::size_t>(call)]; }
    std::int64_t bytes_written() const { return bytes_written_; }

    rocksdb::IOStatus NewWritableFile(const std::string& name, const rocksdb::FileOptions& options,
                                      std::unique_ptr<rocksdb::FSWritableFile>* result,
                                      rocksdb::IODebugContext* context) override;
    rocksdb::IOStatus NewSequentialFile(const std::string& name,
                                        const rocksdb::FileOptions& options,
                                        std::unique_ptr<rocksdb::FSSequentialFile>* result,
                                        rocksdb::IODebugContext* context) override;
    rocksdb::IOStatus NewRandomAccessFile(const std::string& name,
                                          const rocksdb::FileOptions& options,
                                          std::unique_ptr<rocksdb::FSRandomAccessFile>* result,
                                          rocksdb::IODebugContext* context) override;
    rocksdb::IOStatus RenameFile(const std::string& from, const std::string& to,
                                 const rocksdb::IOOptions& options,
                                 rocksdb::IODebugContext* context) override;

    // For the files of this file system.

    /// Counts a call. @return what it is to fail with, or ok
    rocksdb::IOStatus pass(Call call);
    /// Counts an append. @return what it is to fail with, or ok
    rocksdb::IOStatus pass_append(const std::string& name, std::size_t bytes);
    void synced(const std::string& name);

  private:
    struct Size {
        std::uint64_t written = 0;
        std::uint64_t synced = 0;
    };

    std::array<std::atomic<std::int64_t>, 3> counts_{};
    std::array<std::atomic<std::int64_t>, 3> until_failure_{};
    std::atomic<std::int64_t> until_power_cut_{0};
    std::atomic<bool> power_is_cut_{false};
    std::atomic<bool> read_only_{false};
    std::atomic<std::int64_t> free_bytes_{std::int64_t{1} << 60};
    std::atomic<std::int64_t> bytes_written_{0};
    std::mutex mutex_;                   // guards sizes_
    std::map<std::string, Size> sizes_;  // of files written here
};

}  // namespace psfm::testing
