// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/storage/fault_file_system.h"

namespace psfm::testing {
namespace {

class LimitedFile : public rocksdb::FSWritableFileOwnerWrapper {
  public:
    LimitedFile(std::unique_ptr<rocksdb::FSWritableFile> file, FullDisk* disk)
        : FSWritableFileOwnerWrapper(std::move(file)), disk_(disk) {}

    rocksdb::IOStatus Append(const rocksdb::Slice& data, const rocksdb::IOOptions& options,
                             rocksdb::IODebugContext* context) override {
        if (!disk_->take(data.size())) return rocksdb::IOStatus::NoSpace("disk is full");
        return FSWritableFileOwnerWrapper::Append(data, options, context);
    }
    rocksdb::IOStatus Append(const rocksdb::Slice& data, const rocksdb::IOOptions& options,
                             const rocksdb::DataVerificationInfo& info,
                             rocksdb::IODebugContext* context) override {
        if (!disk_->take(data.size())) return rocksdb::IOStatus::NoSpace("disk is full");
        return FSWritableFileOwnerWrapper::Append(data, options, info, context);
    }

  private:
    FullDisk* disk_;
};

}  // namespace

rocksdb::IOStatus FullDisk::NewWritableFile(const std::string& name,
                                            const rocksdb::FileOptions& options,
                                            std::unique_ptr<rocksdb::FSWritableFile>* result,
                                            rocksdb::IODebugContext* context) {
    std::unique_ptr<rocksdb::FSWritableFile> file;
    rocksdb::IOStatus status = FileSystemWrapper::NewWritableFile(name, options, &file, context);
    if (status.ok()) *result = std::make_unique<LimitedFile>(std::move(file), this);
    return status;
}

}  // namespace psfm::testing
