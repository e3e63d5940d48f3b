// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/database/session_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "storage/session/session_store.h"
#include "tests/storage/child_process.h"
#include "tests/storage/test_session.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;
using testing::ChildProcess;
using ::testing::HasSubstr;
using testing::TemporaryFolder;

void write_text(const fs::path& path, const std::string& text) {
    std::ofstream(path) << text;
}

Error open_error(const fs::path& folder) {
    const auto store = SessionStore::open(folder, {});
    EXPECT_FALSE(store.ok());
    return store ? Error{} : store.error();
}

TEST(SessionFolder, IsMadeWithAMarkerForPeople) {
    const TemporaryFolder folder;
    const fs::path session = folder.path() / "deep" / "down";
    ASSERT_TRUE(SessionStore::open(session, {}).ok());
    std::ifstream marker(session / kMarkerFile);
    std::string text((std::istreambuf_iterator<char>(marker)), {});
    EXPECT_EQ(text, "psfm session\nformat 1\n");
}

TEST(SessionFolder, MayBeAnEmptyFolder) {
    const TemporaryFolder folder;
    EXPECT_TRUE(SessionStore::open(folder.path(), {}).ok());
}

TEST(SessionFolder, MustNotBeSomethingElse) {
    const TemporaryFolder folder;
    write_text(folder.path() / "holiday.jpg", "a photograph");
    const Error error = open_error(folder.path());
    EXPECT_EQ(error.code, ErrorCode::kInvalidArgument);
    EXPECT_THAT(error.message, HasSubstr("is not a psfm session; choose an empty or new folder"));
    EXPECT_THAT(error.message, HasSubstr(folder.path().string()));
    // Nothing was left behind in it.
    EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 1);
    EXPECT_EQ(open_error(folder.path() / "holiday.jpg").code, ErrorCode::kInvalidArgument);
}

TEST(SessionFolder, MustNotBeAFolderThatOnlyLooksLikeOurs) {
    const TemporaryFolder folder;
    fs::create_directories(folder.path() / kDatabaseFolder);
    EXPECT_EQ(open_error(folder.path()).code, ErrorCode::kInvalidArgument);
}

TEST(SessionFolder, IsFinishedWhenItsCreationWasInterrupted) {
    const TemporaryFolder folder;
    {
        const auto store = SessionStore::open(folder.session(), {});
        ASSERT_TRUE(store.ok());
        ASSERT_TRUE(testing::commit_all(**store, 0));
    }
    fs::remove(folder.session() / kMarkerFile);
    const auto store = SessionStore::open(folder.session(), {});
    ASSERT_TRUE(store.ok());
    EXPECT_EQ((*store)->images()->size(), 1U);
}

TEST(SessionFolder, OfANewerFormatIsRefused) {
    const TemporaryFolder folder;
    ASSERT_TRUE(SessionStore::open(folder.session(), {}).ok());
    write_text(folder.session() / kMarkerFile, "psfm session\nformat 2\n");
    EXPECT_EQ(open_error(folder.session()).code, ErrorCode::kVersion);
    EXPECT_EQ(open_session_reader(folder.session(), {}).error().code, ErrorCode::kVersion);
}

TEST(SessionFolder, WithADamagedMarkerIsRefused) {
    const TemporaryFolder folder;
    ASSERT_TRUE(SessionStore::open(folder.session(), {}).ok());
    for (const char* text :
         {"", "psfm", "psfm session\n", "psfm session\nformat x\n", "psfm session\nformat 1x\n",
          "psfm session\nformat 0\n", "psfm session\nformat -1\n"}) {
        write_text(folder.session() / kMarkerFile, text);
        EXPECT_EQ(open_error(folder.session()).code, ErrorCode::kDamaged) << text;
    }
}

TEST(SessionFolder, WithoutItsDatabaseIsDamagedAndNotMadeAnew) {
    const TemporaryFolder folder;
    ASSERT_TRUE(SessionStore::open(folder.session(), {}).ok());
    fs::remove_all(folder.session() / kDatabaseFolder);
    EXPECT_EQ(open_error(folder.session()).code, ErrorCode::kDamaged);
    EXPECT_EQ(open_session_reader(folder.session(), {}).error().code, ErrorCode::kDamaged);
}

TEST(SessionFolder, MustExistForOpenExistingAndReaders) {
    const TemporaryFolder folder;
    EXPECT_EQ(SessionStore::open_existing(folder.session(), {}).error().code, ErrorCode::kNotFound);
    EXPECT_EQ(open_session_reader(folder.session(), {}).error().code, ErrorCode::kNotFound);
    EXPECT_FALSE(fs::exists(folder.session()));
    EXPECT_EQ(open_session_reader(folder.path(), {}).error().code, ErrorCode::kNotFound);
    ASSERT_TRUE(SessionStore::open(folder.session(), {}).ok());
    EXPECT_TRUE(SessionStore::open_existing(folder.session(), {}).ok());
}

TEST(SessionLock, RefusesASecondWriterAndNamesTheFirst) {
    const TemporaryFolder folder;
    ChildProcess holder({"hold", folder.session().string()});
    ASSERT_EQ(holder.read_line(), "ready");
    const Error error = open_error(folder.session());
    EXPECT_EQ(error.code, ErrorCode::kInUse);
    EXPECT_THAT(error.message, HasSubstr("process " + std::to_string(holder.pid())));
    EXPECT_EQ(holder.finish(), 0);
    EXPECT_TRUE(SessionStore::open(folder.session(), {}).ok());
}

TEST(SessionLock, HoldsWithinOneProcessToo) {
    const TemporaryFolder folder;
    const auto first = SessionStore::open(folder.session(), {});
    ASSERT_TRUE(first.ok());
    EXPECT_EQ(open_error(folder.session()).code, ErrorCode::kInUse);
}

TEST(SessionLock, OfADeadProcessIsNoObstacle) {
    const TemporaryFolder folder;
    ChildProcess holder({"hold", folder.session().string()});
    ASSERT_EQ(holder.read_line(), "ready");
    holder.kill();
    EXPECT_TRUE(fs::exists(folder.session() / kLockFile));
    EXPECT_TRUE(SessionStore::open(folder.session(), {}).ok());
}

}  // namespace
}  // namespace psfm
