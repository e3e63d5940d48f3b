// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rocksdb/env.h>
#include <rocksdb/file_system.h>

#include <atomic>
#include <memory>

namespace psfm::testing {

/// The file system, on a disk with only so much space for new bytes. Thread-safe.
class FullDisk : public rocksdb::FileSystemWrapper {
  public:
    FullDisk() : FileSystemWrapper(rocksdb::FileSystem::Default()) {}
    const char* Name() const override { return "FullDisk"; }

    void set_free_bytes(std::int64_t bytes) { free_bytes_ = bytes; }
    /// Takes space. @return false when there is not enough
    bool take(std::size_t bytes) {
        return free_bytes_.fetch_sub(static_cast<std::int64_t>(bytes)) >=
               static_cast<std::int64_t>(bytes);
    }
    rocksdb::IOStatus NewWritableFile(const std::string& name, const rocksdb::FileOptions& options,
                                      std::unique_ptr<rocksdb::FSWritableFile>* result,
                                      rocksdb::IODebugContext* context) override;

  private:
    std::atomic<std::int64_t> free_bytes_{std::int64_t{1} << 60};
};

}  // namespace psfm::testing
