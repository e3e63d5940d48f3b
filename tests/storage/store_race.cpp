// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What ThreadSanitizer has to see around RocksDB, and what it must not: a file system of ours that
// counts RocksDB's reads in a plain number, which is a race made on purpose ("seeded"), and one
// that counts them in an atomic one, in a database that is read while it is written ("clean"). With
// a RocksDB that is not instrumented the second is full of reports, whose stacks are lost too often
// to be suppressed by a function's name, and a suppression of the whole library hides the first.
#include <rocksdb/db.h>
#include <rocksdb/env.h>
#include <rocksdb/file_system.h>
#include <rocksdb/table.h>

#include <atomic>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "tests/meeting.h"

namespace {

namespace fs = std::filesystem;

constexpr int kRecords = 2000;
constexpr int kReaders = 3;

template <typename Counter>
struct Reads {
    Counter count{0};
    psfm::testing::Meeting meeting;
    std::atomic<bool> counted{false};
};

template <typename Counter>
class CountedFile : public rocksdb::FSRandomAccessFileOwnerWrapper {
  public:
    CountedFile(std::unique_ptr<rocksdb::FSRandomAccessFile>&& file, Reads<Counter>& reads)
        : FSRandomAccessFileOwnerWrapper(std::move(file)), reads_(&reads) {}

    rocksdb::IOStatus Read(std::uint64_t offset, std::size_t size,
                           const rocksdb::IOOptions& options, rocksdb::Slice* result, char* scratch,
                           rocksdb::IODebugContext* debug) const override {
        if (reads_->counted.load(std::memory_order_relaxed)) {
            reads_->meeting.wait();
            ++reads_->count;
        }
        return FSRandomAccessFileOwnerWrapper::Read(offset, size, options, result, scratch, debug);
    }

  private:
    Reads<Counter>* reads_;
};

template <typename Counter>
class CountingFileSystem : public rocksdb::FileSystemWrapper {
  public:
    explicit CountingFileSystem(Reads<Counter>& reads)
        : FileSystemWrapper(rocksdb::FileSystem::Default()), reads_(&reads) {}
    const char* Name() const override { return "CountingFileSystem"; }

    rocksdb::IOStatus NewRandomAccessFile(const std::string& path,
                                          const rocksdb::FileOptions& options,
                                          std::unique_ptr<rocksdb::FSRandomAccessFile>* result,
                                          rocksdb::IODebugContext* debug) override {
        auto status = FileSystemWrapper::NewRandomAccessFile(path, options, result, debug);
        if (status.ok())
            *result = std::make_unique<CountedFile<Counter>>(std::move(*result), *reads_);
        return status;
    }

  private:
    Reads<Counter>* reads_;
};

std::string key(int record) {
    return "record " + std::to_string(record);
}

void write_all(rocksdb::DB& database) {
    for (int record = 0; record < kRecords; ++record)
        database.Put({}, key(record), std::string(100, 'x'));
}

int read_all(rocksdb::DB& database) {
    int found = 0;
    std::string value;
    for (int record = 0; record < kRecords; ++record)
        found += database.Get({}, key(record), &value).ok() ? 1 : 0;
    return found;
}

/// Writes records, and again while several threads read them. @return reads of files counted
template <typename Counter>
int count_reads(const fs::path& folder) {
    Reads<Counter> reads;
    const auto env = rocksdb::NewCompositeEnv(std::make_shared<CountingFileSystem<Counter>>(reads));
    rocksdb::BlockBasedTableOptions table;
    table.no_block_cache = true;
    rocksdb::Options options;
    options.create_if_missing = true;
    options.env = env.get();
    options.table_factory.reset(rocksdb::NewBlockBasedTableFactory(table));
    rocksdb::DB* opened = nullptr;
    if (!rocksdb::DB::Open(options, folder, &opened).ok()) return 0;
    const std::unique_ptr<rocksdb::DB> database(opened);
    write_all(*database);
    if (!database->Flush({}).ok()) return 0;
    reads.counted.store(true, std::memory_order_relaxed);
    std::atomic<int> found{0};
    std::vector<std::thread> threads;
    for (int reader = 0; reader < kReaders; ++reader)
        threads.emplace_back([&] { found += read_all(*database); });
    write_all(*database);
    for (std::thread& thread : threads) thread.join();
    return found == kReaders * kRecords ? static_cast<int>(reads.count) : 0;
}

}  // namespace

int main(int argc, char** argv) {
    const bool seeded = argc == 3 && std::string_view(argv[1]) == "seeded";
    if (argc != 3) {
        std::fprintf(stderr, "usage: store_race seeded|clean FOLDER\n");
        return 2;
    }
    const fs::path folder = argv[2];
    fs::remove_all(folder);
    const int reads = seeded ? count_reads<int>(folder) : count_reads<std::atomic<int>>(folder);
    fs::remove_all(folder);
    std::printf("%d reads of files\n", reads);
    return reads > 0 ? 0 : 1;
}
