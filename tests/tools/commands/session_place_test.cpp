// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/exchange/session_place.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/storage/exchange/example_model.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;

class SessionPlaceTest : public testing::Test {
  protected:
    std::string path(const std::string& name) const { return (folder_.path() / name).string(); }

    /// Makes what stands for a session, and moves it there.
    static Result<void> make(const SessionPlace& place) {
        fs::create_directories(place.beside() / "db");
        return place.move_there();
    }
    void expect_refused(const std::string& name, const std::string& why) const {
        const auto place = SessionPlace::find(path(name));
        ASSERT_FALSE(place.ok()) << name;
        EXPECT_EQ(place.error().code, ErrorCode::kInvalidArgument);
        EXPECT_NE(place.error().message.find(why), std::string::npos) << place.error().message;
    }

    test::TemporaryFolder folder_;
};

TEST_F(SessionPlaceTest, NewOrEmptyFoldersBecomeSessions) {
    fs::create_directory(path("empty"));
    for (const char* name : {"new", "slash/", "empty"}) {
        const auto place = SessionPlace::find(path(name));
        ASSERT_TRUE(place.ok()) << name;
        EXPECT_FALSE(place->is_taken());
        EXPECT_EQ(place->beside().parent_path(), fs::canonical(folder_.path()));
        EXPECT_TRUE(make(*place).ok()) << name;
        EXPECT_TRUE(place->is_taken());
        EXPECT_TRUE(fs::is_directory(fs::path(path(name)) / "db"));
        EXPECT_FALSE(fs::exists(place->beside()));
    }
}

TEST_F(SessionPlaceTest, LinksAreFollowed) {
    fs::create_directory(path("disk"));
    fs::create_directory_symlink("disk", path("link"));
    const auto place = SessionPlace::find(path("link"));
    ASSERT_TRUE(place.ok());
    ASSERT_TRUE(make(*place).ok());
    EXPECT_TRUE(fs::is_symlink(path("link")));
    EXPECT_TRUE(fs::is_directory(path("disk/db")));
}

TEST_F(SessionPlaceTest, WhatPeopleHaveThereStays) {
    fs::create_symlink("nowhere", path("dangling"));
    expect_refused("dangling", "leads nowhere");
    EXPECT_TRUE(fs::is_symlink(path("dangling")));
    test::put_file(path("file"), "");
    expect_refused("file", "is not a folder");
    EXPECT_TRUE(fs::is_regular_file(path("file")));
    fs::create_directory(path("here"));
    const fs::path before = fs::current_path();
    fs::current_path(path("here"));
    expect_refused("here", "runs in");
    fs::current_path(before);
    EXPECT_TRUE(fs::is_empty(path("here")));
}

TEST_F(SessionPlaceTest, ThePlaceMayBeTakenMeanwhile) {
    const auto first = SessionPlace::find(path("session"));
    const auto second = SessionPlace::find(path("session"));
    ASSERT_TRUE(first.ok() && second.ok());
    ASSERT_TRUE(make(*first).ok());
    const auto made = make(*second);
    ASSERT_FALSE(made.ok());
    EXPECT_EQ(made.error().code, ErrorCode::kInUse);
    EXPECT_NE(made.error().message.find("psfm resume --session"), std::string::npos);
    EXPECT_FALSE(fs::exists(second->beside()));
    EXPECT_TRUE(fs::is_directory(path("session/db")));
}

TEST_F(SessionPlaceTest, WhatKilledProgramsLeftIsRemoved) {
    const pid_t gone = fork();
    if (gone == 0) _exit(0);
    ASSERT_EQ(waitpid(gone, nullptr, 0), gone);
    const std::string left = path("session.importing-" + std::to_string(gone));
    const std::string running = path("session.importing-" + std::to_string(getpid()));
    for (const std::string& folder :
         {path("session/db"), left, running, path("session.importing-mine")})
        fs::create_directories(folder);
    const auto place = SessionPlace::find(path("session"));
    ASSERT_TRUE(place.ok());
    EXPECT_TRUE(place->is_taken());
    EXPECT_FALSE(fs::exists(left));
    EXPECT_TRUE(fs::exists(running));
    EXPECT_TRUE(fs::exists(path("session.importing-mine")));
}

}  // namespace
}  // namespace psfm
