// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/database/log_structure.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tests/storage/child_process.h"
#include "tests/storage/test_session.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kBlockSize = 32768;
constexpr std::size_t kHeaderSize = 7;

std::string bytes_of(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// A write-ahead log of some batches, and where its records begin.
struct Log {
    std::string bytes;
    std::vector<std::size_t> records;
};

Log log_of_a_killed_session() {
    const testing::TemporaryFolder folder;
    testing::ChildProcess writer({"leave", folder.session().string(), "6"});
    while (!writer.read_line().empty()) {
    }
    EXPECT_EQ(writer.finish(), 0);
    Log log;
    for (const auto& entry : fs::directory_iterator(folder.session() / "db")) {
        if (entry.path().extension() == ".log") log.bytes += bytes_of(entry.path());
    }
    for (std::size_t at = 0; at + kHeaderSize <= log.bytes.size();) {
        log.records.push_back(at);
        const auto low = static_cast<unsigned char>(log.bytes[at + 4]);
        const auto high = static_cast<unsigned char>(log.bytes[at + 5]);
        at += kHeaderSize + low + 256U * high;
        const std::size_t left = kBlockSize - at % kBlockSize;
        if (left < kHeaderSize) at += left;
    }
    return log;
}

TEST(LogStructure, EveryPrefixIsAsACrashMayLeaveIt) {
    const Log log = log_of_a_killed_session();
    ASSERT_GT(log.bytes.size(), kBlockSize) << "a record goes over the end of a block";
    EXPECT_FALSE(is_damaged_inside(log.bytes));
    for (std::size_t size = 0; size < log.bytes.size(); size += 13)
        EXPECT_FALSE(is_damaged_inside(std::string_view(log.bytes).substr(0, size))) << size;
    EXPECT_FALSE(is_damaged_inside(log.bytes + std::string(100, '\0'))) << "space in advance";
}

TEST(LogStructure, ADamagedRecordBeforeTheLastBatchIsSeen) {
    Log log = log_of_a_killed_session();
    ASSERT_GT(log.records.size(), 10U);
    // The last batch takes one record, or two at the end of a block.
    for (std::size_t record = 0; record + 3 < log.records.size(); ++record) {
        for (std::size_t byte = 0; byte < kHeaderSize + 1; ++byte) {
            for (int bit = 0; bit < 8; ++bit) {
                char& value = log.bytes[log.records[record] + byte];
                const char before = value;
                value = static_cast<char>(value ^ (1 << bit));
                EXPECT_TRUE(is_damaged_inside(log.bytes)) << record << ' ' << byte << ' ' << bit;
                value = before;
            }
        }
    }
}

TEST(LogStructure, ARecordOfNoTypeIsDamageAlsoAtTheEnd) {
    Log log = log_of_a_killed_session();
    log.bytes[log.records.back() + 6] = 5;
    EXPECT_TRUE(is_damaged_inside(log.bytes)) << "RocksDB ends the process there";
}

}  // namespace
}  // namespace psfm
