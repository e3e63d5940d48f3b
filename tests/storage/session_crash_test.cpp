// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "storage/session/store_seams.h"
#include "tests/storage/child_process.h"
#include "tests/storage/fault_file_system.h"
#include "tests/storage/test_session.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;
using testing::ChildProcess;
using testing::TemporaryFolder;

TEST(SessionCrash, LosesNothingThatWasAcknowledgedWhenKilled) {
    const TemporaryFolder folder;
    std::uint32_t acknowledged = 0;
    for (const int lines : {1, 5, 9, 2, 14}) {
        ChildProcess writer({"write", folder.session().string(), "100000"});
        for (int i = 0; i < lines; ++i) {
            acknowledged = static_cast<std::uint32_t>(std::stoul(writer.read_line())) + 1;
        }
        writer.kill();
        const auto store = SessionStore::open_existing(folder.session(), {});
        ASSERT_TRUE(store.ok()) << store.error().message;
        EXPECT_GE((*store)->images()->size(), acknowledged);
        EXPECT_GE((*store)->scene()->version, acknowledged);
        EXPECT_EQ(testing::difference(**store), "");
        EXPECT_TRUE((*store)->check({})->damaged.empty());
        const auto images = static_cast<std::uint32_t>((*store)->images()->size());
        ASSERT_TRUE(testing::finish(**store, images));
    }
}

/// Cuts the write-ahead log at many lengths: every prefix is a session of whole commits.
TEST(SessionCrash, ATornLogEndsAtAWholeCommit) {
    const TemporaryFolder folder;
    ChildProcess writer({"leave", folder.session().string(), "6"});
    while (!writer.read_line().empty()) {
    }
    ASSERT_EQ(writer.finish(), 0);
    fs::path log;
    for (const auto& entry : fs::directory_iterator(folder.session() / "db")) {
        if (entry.path().extension() == ".log" && entry.file_size() > 0) log = entry.path();
    }
    ASSERT_FALSE(log.empty());
    const auto size = fs::file_size(log);
    std::uint64_t versions_seen = 0;
    for (std::uintmax_t cut = 0; cut <= size; cut += size / 40) {
        const fs::path copy = folder.path() / "copy";
        fs::remove_all(copy);
        fs::copy(folder.session(), copy, fs::copy_options::recursive);
        fs::resize_file(copy / "db" / log.filename(), cut);
        const auto store = SessionStore::open_existing(copy, {});
        ASSERT_TRUE(store.ok()) << store.error().message;
        EXPECT_EQ(testing::difference(**store), "") << "cut at " << cut;
        EXPECT_TRUE((*store)->check({})->damaged.empty()) << "cut at " << cut;
        versions_seen |= std::uint64_t{1} << (*store)->scene()->version;
    }
    // Versions 0 to 5 at least have been the last one at some cut.
    EXPECT_EQ(versions_seen & 0x3fU, 0x3fU);
}

TEST(SessionCrash, AFullDiskIsSaidAndHarmless) {
    const auto disk = std::make_shared<testing::FaultFileSystem>();
    const std::unique_ptr<rocksdb::Env> env = testing::make_env(disk);
    const TemporaryFolder folder;
    std::uint32_t whole = 0;
    {
        const auto store =
            open_session_store(folder.session(), {}, OpenMode::kOpenOrCreate, {env.get()});
        ASSERT_TRUE(store.ok()) << store.error().message;
        for (; whole < 4; ++whole) ASSERT_TRUE(testing::commit_all(**store, whole));
        disk->set_free_bytes(1000);
        const auto commit = [&] {
            return (*store)->commit_image(
                testing::expected_image(whole), testing::expected_camera(),
                testing::expected_keypoints(whole), testing::expected_descriptors(whole));
        };
        const Result<void> full = commit();
        ASSERT_FALSE(full.ok());
        EXPECT_EQ(full.error().code, ErrorCode::kNoSpace);
        EXPECT_THAT(full.error().message, ::testing::HasSubstr("make space"));
        // No commit slips in behind one that failed, even when there is space again.
        disk->set_free_bytes(std::int64_t{1} << 40);
        EXPECT_EQ(commit().error().code, ErrorCode::kNoSpace);
        EXPECT_EQ(testing::difference(**store), "");
    }
    const auto store = SessionStore::open_existing(folder.session(), {});
    ASSERT_TRUE(store.ok()) << store.error().message;
    EXPECT_EQ((*store)->images()->size(), whole);
    EXPECT_EQ(testing::difference(**store), "");
    EXPECT_TRUE(testing::commit_all(**store, whole));
    EXPECT_TRUE((*store)->check({})->damaged.empty());
}

TEST(SessionCrash, AFullDiskAtCreationLeavesAFolderThatCanBeUsedLater) {
    const auto disk = std::make_shared<testing::FaultFileSystem>();
    const std::unique_ptr<rocksdb::Env> env = testing::make_env(disk);
    const TemporaryFolder folder;
    for (const std::int64_t bytes : {0, 100, 400, 1000}) {
        disk->set_free_bytes(bytes);
        const auto store =
            open_session_store(folder.session(), {}, OpenMode::kOpenOrCreate, {env.get()});
        if (store) break;
        EXPECT_EQ(store.error().code, ErrorCode::kNoSpace) << store.error().message;
    }
    disk->set_free_bytes(std::int64_t{1} << 40);
    const auto store = SessionStore::open(folder.session(), {});
    ASSERT_TRUE(store.ok()) << store.error().message;
    EXPECT_TRUE(testing::commit_all(**store, 0));
}

}  // namespace
}  // namespace psfm
