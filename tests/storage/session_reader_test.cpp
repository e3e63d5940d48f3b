// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <set>
#include <thread>

#include "storage/database/session_folder.h"
#include "tests/storage/child_process.h"
#include "tests/storage/test_session.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;
using testing::ChildProcess;
using testing::TemporaryFolder;

std::size_t reader_folders(const fs::path& session) {
    if (!fs::exists(session / kReadersFolder)) return 0;
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(session / kReadersFolder), {}));
}

TEST(SessionReader, SeesWhatAWriterOfTheSameProcessCommits) {
    const TemporaryFolder folder;
    const auto store = SessionStore::open(folder.session(), {});
    ASSERT_TRUE(store.ok());
    const auto reader = open_session_reader(folder.session(), {});
    ASSERT_TRUE(reader.ok()) << reader.error().message;
    EXPECT_TRUE((*reader)->images()->empty());
    for (std::uint32_t image = 0; image < 6; ++image) {
        ASSERT_TRUE(testing::commit_all(**store, image));
        ASSERT_TRUE((*reader)->refresh().ok());
        EXPECT_EQ((*reader)->images()->size(), image + 1);
        EXPECT_EQ((*reader)->scene()->version, image + 1);
        EXPECT_EQ(testing::difference(**reader), "");
    }
    EXPECT_TRUE((*reader)->check({})->damaged.empty());
}

TEST(SessionReader, ReadsASessionThatNobodyWrites) {
    const TemporaryFolder folder;
    {
        const auto store = SessionStore::open(folder.session(), {});
        ASSERT_TRUE(store.ok());
        for (std::uint32_t image = 0; image < 5; ++image) {
            ASSERT_TRUE(testing::commit_all(**store, image));
        }
    }
    const auto reader = open_session_reader(folder.session(), {});
    ASSERT_TRUE(reader.ok());
    EXPECT_EQ((*reader)->images()->size(), 5U);
    EXPECT_EQ(testing::difference(**reader), "");
}

TEST(SessionReader, ReadsASessionThatItMayNotWriteTo) {
    const TemporaryFolder folder;
    {
        const auto store = SessionStore::open(folder.session(), {});
        ASSERT_TRUE(store.ok());
        for (std::uint32_t image = 0; image < 5; ++image) {
            ASSERT_TRUE(testing::commit_all(**store, image));
        }
    }
    const auto may_read = fs::perms::owner_read | fs::perms::owner_exec | fs::perms::group_read |
                          fs::perms::group_exec | fs::perms::others_read | fs::perms::others_exec;
    fs::permissions(folder.path(), fs::perms::owner_all | may_read);
    fs::permissions(folder.session(), may_read);
    // What a reader that was killed left among the temporary files goes; what is in use stays.
    const fs::path temporary = folder.path() / "tmp";
    fs::create_directories(temporary / "psfm-reader-killed");
    fs::create_directories(temporary / "psfm-reader-at-work");
    fs::create_directories(temporary / "others");
    fs::permissions(temporary, fs::perms::all);
    const int at_work = ::open((temporary / "psfm-reader-at-work").c_str(), O_RDONLY | O_CLOEXEC);
    ASSERT_EQ(::flock(at_work, LOCK_EX), 0);
    ::setenv("TMPDIR", temporary.c_str(), 1);
    ChildProcess reader({"read", folder.session().string()});
    EXPECT_EQ(reader.read_line(), "5");
    EXPECT_EQ(reader.finish(), 0);
    EXPECT_FALSE(fs::exists(folder.session() / kReadersFolder));
    std::set<std::string> left;
    for (const auto& entry : fs::directory_iterator(temporary))
        left.insert(entry.path().filename());
    EXPECT_EQ(left, (std::set<std::string>{"others", "psfm-reader-at-work"}));

    fs::permissions(temporary, may_read);
    ChildProcess denied({"read", folder.session().string()});
    const std::string said = denied.read_line();
    EXPECT_NE(said.find("in '" + temporary.string() + "'"), std::string::npos) << said;
    EXPECT_NE(said.find("TMPDIR="), std::string::npos) << said;
    EXPECT_NE(denied.finish(), 0);
    ::unsetenv("TMPDIR");
    ::close(at_work);
    fs::permissions(temporary, fs::perms::owner_all);
    fs::permissions(folder.session(), fs::perms::owner_all);
}

TEST(SessionReader, NamesWhatItMayNotRead) {
    const TemporaryFolder folder;
    ASSERT_TRUE(SessionStore::open(folder.session(), {}).ok());
    fs::permissions(folder.path(), fs::perms::all);
    fs::permissions(folder.session(), fs::perms::all);
    for (const char* name : {kLockFile, kMarkerFile, "db/CURRENT", "db"}) {
        const fs::path denied = folder.session() / name;
        const fs::perms before = fs::status(denied).permissions();
        fs::permissions(denied, fs::perms::none);
        ChildProcess reader({"read", folder.session().string()});
        const std::string said = reader.read_line();
        EXPECT_NE(said.find(denied.string()), std::string::npos) << said;
        EXPECT_NE(said.find("chmod"), std::string::npos) << said;
        EXPECT_NE(reader.finish(), 0);
        fs::permissions(denied, before);
    }
}

TEST(SessionReader, FollowsABusyWriterInAnotherProcess) {
    const TemporaryFolder folder;
    constexpr std::uint32_t kImages = 60;
    ChildProcess writer({"write", folder.session().string(), std::to_string(kImages)});
    ASSERT_EQ(writer.read_line(), "0");
    const auto reader = open_session_reader(folder.session(), {});
    ASSERT_TRUE(reader.ok()) << reader.error().message;
    std::uint64_t before = 0;
    // What the writer has acknowledged is there at the next refresh, whole, and never goes back.
    for (std::string line = writer.read_line(); !line.empty(); line = writer.read_line()) {
        const std::uint64_t acknowledged = std::stoull(line) + 1;
        ASSERT_TRUE((*reader)->refresh().ok());
        const auto scene = (*reader)->scene();
        ASSERT_TRUE(scene.ok()) << scene.error().message;
        EXPECT_GE(scene->version, acknowledged);
        EXPECT_GE(scene->version, before);
        before = scene->version;
        ASSERT_EQ(testing::difference(**reader), "");
    }
    EXPECT_EQ(writer.finish(), 0);
    ASSERT_TRUE((*reader)->refresh().ok());
    EXPECT_EQ((*reader)->scene()->version, kImages);
    const auto report = (*reader)->check({});
    EXPECT_TRUE(report->damaged.empty());
}

TEST(SessionReader, IsSafeToUseFromManyThreadsWhileItFollows) {
    const TemporaryFolder folder;
    ChildProcess writer({"write", folder.session().string(), "40"});
    ASSERT_EQ(writer.read_line(), "0");
    const auto reader = open_session_reader(folder.session(), {});
    ASSERT_TRUE(reader.ok());
    std::vector<std::jthread> threads;
    for (int t = 0; t < 3; ++t) {
        threads.emplace_back([&reader] {
            for (int i = 0; i < 10; ++i) {
                EXPECT_EQ(testing::difference(**reader), "");
                EXPECT_TRUE((*reader)->refresh().ok());
            }
        });
    }
    threads.clear();
    EXPECT_EQ(writer.finish(), 0);
}

TEST(SessionReader, CleansUpBehindItselfAndBehindTheDead) {
    const TemporaryFolder folder;
    ASSERT_TRUE(SessionStore::open(folder.session(), {}).ok());
    {
        const auto first = open_session_reader(folder.session(), {});
        const auto second = open_session_reader(folder.session(), {});
        ASSERT_TRUE(first.ok() && second.ok());
        EXPECT_EQ(reader_folders(folder.session()), 2U);
        fs::create_directory(folder.session() / kReadersFolder / "12345-0");
        // The writer removes what nobody holds, and only that.
        ASSERT_TRUE(SessionStore::open(folder.session(), {}).ok());
        EXPECT_EQ(reader_folders(folder.session()), 2U);
    }
    EXPECT_EQ(reader_folders(folder.session()), 0U);
}

}  // namespace
}  // namespace psfm
