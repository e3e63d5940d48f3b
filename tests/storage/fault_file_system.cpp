// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/storage/fault_file_system.h"

#include <rocksdb/system_clock.h>

#include <filesystem>

namespace psfm::testing {
namespace {

using rocksdb::IODebugContext;
using rocksdb::IOOptions;
using rocksdb::IOStatus;
using rocksdb::Slice;
using Call = FaultFileSystem::Call;

class WrittenFile : public rocksdb::FSWritableFileOwnerWrapper {
  public:
    WrittenFile(std::unique_ptr<rocksdb::FSWritableFile> file, std::string name,
                FaultFileSystem* disk)
        : FSWritableFileOwnerWrapper(std::move(file)), name_(std::move(name)), disk_(disk) {}

    IOStatus Append(const Slice& data, const IOOptions& options, IODebugContext* context) override {
        IOStatus status = disk_->pass_append(name_, data.size());
        if (!status.ok()) return status;
        return FSWritableFileOwnerWrapper::Append(data, options, context);
    }
    IOStatus Append(const Slice& data, const IOOptions& options,
                    const rocksdb::DataVerificationInfo& info, IODebugContext* context) override {
        IOStatus status = disk_->pass_append(name_, data.size());
        if (!status.ok()) return status;
        return FSWritableFileOwnerWrapper::Append(data, options, info, context);
    }
    IOStatus Sync(const IOOptions& options, IODebugContext* context) override {
        return sync([&] { return FSWritableFileOwnerWrapper::Sync(options, context); });
    }
    IOStatus Fsync(const IOOptions& options, IODebugContext* context) override {
        return sync([&] { return FSWritableFileOwnerWrapper::Fsync(options, context); });
    }

  private:
    template <typename Real>
    IOStatus sync(const Real& real) {
        IOStatus status = disk_->pass(Call::kSync);
        if (status.ok()) status = real();
        if (status.ok()) disk_->synced(name_);
        return status;
    }

    std::string name_;
    FaultFileSystem* disk_;
};

class SequentialFile : public rocksdb::FSSequentialFileOwnerWrapper {
  public:
    SequentialFile(std::unique_ptr<rocksdb::FSSequentialFile> file, FaultFileSystem* disk)
        : FSSequentialFileOwnerWrapper(std::move(file)), disk_(disk) {}
    IOStatus Read(std::size_t size, const IOOptions& options, Slice* result, char* scratch,
                  IODebugContext* context) override {
        IOStatus status = disk_->pass(Call::kRead);
        if (!status.ok()) return status;
        return FSSequentialFileOwnerWrapper::Read(size, options, result, scratch, context);
    }

  private:
    FaultFileSystem* disk_;
};

class RandomAccessFile : public rocksdb::FSRandomAccessFileOwnerWrapper {
  public:
    RandomAccessFile(std::unique_ptr<rocksdb::FSRandomAccessFile> file, FaultFileSystem* disk)
        : FSRandomAccessFileOwnerWrapper(std::move(file)), disk_(disk) {}
    IOStatus Read(std::uint64_t offset, std::size_t size, const IOOptions& options, Slice* result,
                  char* scratch, IODebugContext* context) const override {
        IOStatus status = disk_->pass(Call::kRead);
        if (!status.ok()) return status;
        return FSRandomAccessFileOwnerWrapper::Read(offset, size, options, result, scratch,
                                                    context);
    }

  private:
    FaultFileSystem* disk_;
};

class ShortSleeps : public rocksdb::SystemClockWrapper {
  public:
    ShortSleeps() : SystemClockWrapper(rocksdb::SystemClock::Default()) {}
    const char* Name() const override { return "ShortSleeps"; }
    void SleepForMicroseconds(int micros) override {
        SystemClockWrapper::SleepForMicroseconds(micros / 100);
    }
};

class FaultEnv : public rocksdb::EnvWrapper {
  public:
    explicit FaultEnv(std::shared_ptr<FaultFileSystem> files)
        : EnvWrapper(rocksdb::NewCompositeEnv(files)) {
        system_clock_ = std::make_shared<ShortSleeps>();
    }
};

}  // namespace

std::unique_ptr<rocksdb::Env> make_env(std::shared_ptr<FaultFileSystem> files) {
    return std::make_unique<FaultEnv>(std::move(files));
}

void FaultFileSystem::fail_once(Call call, std::int64_t n) {
    until_failure_[static_cast<std::size_t>(call)] = n;
}

IOStatus FaultFileSystem::pass(Call call) {
    const auto index = static_cast<std::size_t>(call);
    ++counts_[index];
    if (call != Call::kRead) {
        if (until_power_cut_ > 0 && --until_power_cut_ == 0) power_is_cut_ = true;
        if (power_is_cut_) return IOStatus::IOError("the power is cut");
        if (read_only_) return IOStatus::IOError("Read-only file system");
    }
    if (until_failure_[index] > 0 && --until_failure_[index] == 0) {
        return IOStatus::IOError("injected failure");
    }
    return IOStatus::OK();
}

IOStatus FaultFileSystem::pass_append(const std::string& name, std::size_t bytes) {
    IOStatus status = pass(Call::kAppend);
    if (!status.ok()) return status;
    const auto size = static_cast<std::int64_t>(bytes);
    if (free_bytes_.fetch_sub(size) < size) return IOStatus::NoSpace("disk is full");
    bytes_written_ += size;
    const std::lock_guard lock(mutex_);
    sizes_[name].written += bytes;
    return status;
}

void FaultFileSystem::synced(const std::string& name) {
    const std::lock_guard lock(mutex_);
    sizes_[name].synced = sizes_[name].written;
}

void FaultFileSystem::lose_unsynced() {
    const std::lock_guard lock(mutex_);
    for (const auto& [name, size] : sizes_) {
        std::error_code gone;  // deleted since
        const auto now = std::filesystem::file_size(name, gone);
        if (!gone && size.synced < now) std::filesystem::resize_file(name, size.synced);
    }
    sizes_.clear();
}

IOStatus FaultFileSystem::NewWritableFile(const std::string& name,
                                          const rocksdb::FileOptions& options,
                                          std::unique_ptr<rocksdb::FSWritableFile>* result,
                                          IODebugContext* context) {
    if (read_only_) return IOStatus::IOError("Read-only file system");
    if (power_is_cut_) return IOStatus::IOError("the power is cut");
    std::unique_ptr<rocksdb::FSWritableFile> file;
    IOStatus status = FileSystemWrapper::NewWritableFile(name, options, &file, context);
    if (!status.ok()) return status;
    *result = std::make_unique<WrittenFile>(std::move(file), name, this);
    const std::lock_guard lock(mutex_);
    sizes_[name] = {};
    return status;
}

IOStatus FaultFileSystem::NewSequentialFile(const std::string& name,
                                            const rocksdb::FileOptions& options,
                                            std::unique_ptr<rocksdb::FSSequentialFile>* result,
                                            IODebugContext* context) {
    std::unique_ptr<rocksdb::FSSequentialFile> file;
    IOStatus status = FileSystemWrapper::NewSequentialFile(name, options, &file, context);
    if (status.ok()) *result = std::make_unique<SequentialFile>(std::move(file), this);
    return status;
}

IOStatus FaultFileSystem::NewRandomAccessFile(const std::string& name,
                                              const rocksdb::FileOptions& options,
                                              std::unique_ptr<rocksdb::FSRandomAccessFile>* result,
                                              IODebugContext* context) {
    std::unique_ptr<rocksdb::FSRandomAccessFile> file;
    IOStatus status = FileSystemWrapper::NewRandomAccessFile(name, options, &file, context);
    if (status.ok()) *result = std::make_unique<RandomAccessFile>(std::move(file), this);
    return status;
}

IOStatus FaultFileSystem::RenameFile(const std::string& from, const std::string& to,
                                     const IOOptions& options, IODebugContext* context) {
    if (power_is_cut_) return IOStatus::IOError("the power is cut");
    IOStatus status = FileSystemWrapper::RenameFile(from, to, options, context);
    const std::lock_guard lock(mutex_);
    if (const auto known = sizes_.extract(from); status.ok() && known) {
        sizes_[to] = known.mapped();
    }
    return status;
}

}  // namespace psfm::testing
