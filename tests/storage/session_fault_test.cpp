// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// A session on a disk that fails, at one point after the other: an error with a remedy, nothing
// that was acknowledged lost, and the session goes on once the fault is gone.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "storage/session/store_seams.h"
#include "tests/storage/fault_file_system.h"
#include "tests/storage/test_session.h"

namespace psfm {
namespace {

using testing::FaultFileSystem;
using testing::TemporaryFolder;
using Call = FaultFileSystem::Call;
using ::testing::AnyOf;
using ::testing::HasSubstr;

constexpr std::uint32_t kImages = 5;

/// A session on such a disk.
struct Disk {
    std::shared_ptr<FaultFileSystem> faults = std::make_shared<FaultFileSystem>();
    std::unique_ptr<rocksdb::Env> env = testing::make_env(faults);
    TemporaryFolder folder;

    Result<std::unique_ptr<SessionStore>> open() {
        return open_session_store(folder.session(), {}, OpenMode::kOpenOrCreate, {env.get()});
    }
};

struct Outcome {
    std::uint32_t whole_images = 0;  ///< all of whose commits returned
    std::optional<Error> error;      ///< of what failed first
};

/// Commits images until one fails, or all are there. The store is closed then.
Outcome commit_images(Disk& disk) {
    Outcome outcome;
    const auto store = disk.open();
    if (!store) return {0, store.error()};
    for (; outcome.whole_images < kImages; ++outcome.whole_images) {
        if (testing::commit_all(**store, outcome.whole_images)) continue;
        // What failed is said again: no commit slips in behind it.
        const Result<void> again = (*store)->put_settings({});
        if (again)
            ADD_FAILURE() << "a commit after one that failed";
        else
            outcome.error = again.error();
        EXPECT_EQ(testing::difference(**store), "");
        break;
    }
    return outcome;
}

/// The fault is gone: everything acknowledged is there, and the session ends as it should.
void expect_it_goes_on(const TemporaryFolder& folder, const Outcome& outcome) {
    const auto store = SessionStore::open(folder.session(), {});
    ASSERT_TRUE(store.ok()) << store.error().message;
    EXPECT_GE((*store)->images()->size(), outcome.whole_images);
    EXPECT_GE((*store)->scene()->version, outcome.whole_images);
    EXPECT_EQ(testing::difference(**store), "");
    const auto report = (*store)->check({});
    ASSERT_TRUE(report.ok());
    for (const DamagedRecord& record : report->damaged) {
        ADD_FAILURE() << record.kind << " " << record.key << ": " << record.problem;
    }
    ASSERT_TRUE(testing::finish(**store, kImages));
    EXPECT_EQ(testing::difference(**store), "");
    EXPECT_EQ((*store)->images()->size(), kImages);
}

std::int64_t total(const std::function<std::int64_t(const FaultFileSystem&)>& of) {
    Disk disk;
    EXPECT_FALSE(commit_images(disk).error);
    return of(*disk.faults);
}

TEST(SessionFaults, AFullDiskAtAnyPointLosesNothing) {
    const std::int64_t bytes = total([](const auto& disk) { return disk.bytes_written(); });
    constexpr int kPoints = 40;
    int failed = 0;
    for (int point = 0; point < kPoints; ++point) {
        SCOPED_TRACE(point);
        Disk disk;
        disk.faults->set_free_bytes(bytes * point / kPoints);
        const Outcome outcome = commit_images(disk);
        if (outcome.error) {
            ++failed;
            EXPECT_EQ(outcome.error->code, ErrorCode::kNoSpace) << outcome.error->message;
            EXPECT_THAT(outcome.error->message, HasSubstr("make space"));
        }
        expect_it_goes_on(disk.folder, outcome);
    }
    EXPECT_GE(failed, 20) << "closing a store writes, too, and may be what has no space";
}

class OneFailure : public ::testing::TestWithParam<Call> {};

TEST_P(OneFailure, OfAWriteOrSyncLosesNothing) {
    const std::int64_t calls = total([](const auto& disk) { return disk.calls(GetParam()); });
    ASSERT_GT(calls, 20);
    int failed = 0;
    for (std::int64_t n = 1; n <= calls; n += std::max<std::int64_t>(1, calls / 40)) {
        SCOPED_TRACE(n);
        Disk disk;
        disk.faults->fail_once(GetParam(), n);
        const Outcome outcome = commit_images(disk);
        if (outcome.error) {
            ++failed;
            EXPECT_EQ(outcome.error->code, ErrorCode::kIo) << outcome.error->message;
            EXPECT_THAT(outcome.error->message, HasSubstr("injected failure"));
            EXPECT_THAT(outcome.error->message, HasSubstr("psfm resume"));
        }
        expect_it_goes_on(disk.folder, outcome);
    }
    EXPECT_GT(failed, 10);
}

INSTANTIATE_TEST_SUITE_P(SessionFaults, OneFailure, ::testing::Values(Call::kAppend, Call::kSync),
                         [](const auto& call) {
                             return call.param == Call::kAppend ? "Append" : "Sync";
                         });

TEST(SessionFaults, APowerCutAtAnyWriteOrSyncLosesNothingAcknowledged) {
    const std::int64_t calls =
        total([](const auto& disk) { return disk.calls(Call::kAppend) + disk.calls(Call::kSync); });
    int failed = 0;
    for (std::int64_t n = 1; n <= calls; n += std::max<std::int64_t>(1, calls / 60)) {
        SCOPED_TRACE(n);
        Disk disk;
        disk.faults->cut_power(n);
        const Outcome outcome = commit_images(disk);
        failed += outcome.error ? 1 : 0;
        disk.faults->lose_unsynced();
        expect_it_goes_on(disk.folder, outcome);
    }
    EXPECT_GT(failed, 20);
}

TEST(SessionFaults, AFailedReadIsSaidAndHarmless) {
    Disk disk;
    ASSERT_FALSE(commit_images(disk).error);
    const std::int64_t before = disk.faults->calls(Call::kRead);
    const auto read_all = [&]() -> std::string {
        const auto store = disk.open();
        if (!store) return store.error().message;
        return testing::difference(**store);
    };
    ASSERT_EQ(read_all(), "");
    const std::int64_t reads = disk.faults->calls(Call::kRead) - before;
    ASSERT_GT(reads, 20);
    int said = 0;
    for (std::int64_t n = 1; n <= reads; ++n) {
        SCOPED_TRACE(n);
        disk.faults->fail_once(Call::kRead, n);
        const std::string problem = read_all();
        disk.faults->fail_once(Call::kRead, 0);
        if (!problem.empty()) {
            ++said;
            EXPECT_THAT(problem, HasSubstr("injected failure"));
            EXPECT_EQ(problem.find("differ"), std::string::npos) << problem;
        }
    }
    EXPECT_GT(said, reads / 2);
    expect_it_goes_on(disk.folder, {kImages, std::nullopt});
}

TEST(SessionFaults, AReadOnlyDiskIsSaid) {
    Disk disk;
    ASSERT_FALSE(commit_images(disk).error);
    disk.faults->set_read_only(true);
    const auto refused = disk.open();
    ASSERT_FALSE(refused.ok());
    EXPECT_EQ(refused.error().code, ErrorCode::kIo);
    EXPECT_THAT(refused.error().message, HasSubstr("Read-only"));
    disk.faults->set_read_only(false);
    expect_it_goes_on(disk.folder, {kImages, std::nullopt});
}

}  // namespace
}  // namespace psfm
