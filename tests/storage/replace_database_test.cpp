// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/database/replace_database.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "storage/database/session_folder.h"
#include "storage/session/session_store.h"
#include "tests/storage/test_session.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using testing::TemporaryFolder;

constexpr std::uint32_t kDamagedImages = 1, kRepairedImages = 3;

/// Sessions of different size, so that it is seen which database lies where.
class ReplaceDatabase : public ::testing::Test {
  protected:
    void SetUp() override {
        make(session_, kDamagedImages);
        make(repaired_, kRepairedImages);
        fs::create_directories(session_ / "photographs/1");
        std::ofstream(session_ / "photographs/1/a.jpg") << "a photograph";
        std::ofstream(session_ / "users.json") << "users";
    }

    static void make(const fs::path& folder, std::uint32_t images) {
        const auto store = SessionStore::open(folder, {});
        ASSERT_TRUE(store.ok());
        for (std::uint32_t image = 0; image < images; ++image)
            ASSERT_TRUE(testing::commit_all(**store, image));
    }

    static std::size_t images_in(const fs::path& folder) {
        const auto reader = open_session_reader(folder, {});
        return reader.ok() ? (*reader)->images()->size() : 0;
    }

    Result<void> replace() const { return replace_database(session_, repaired_, damaged_); }

    void expect_replaced() const {
        EXPECT_EQ(images_in(session_), kRepairedImages);
        EXPECT_EQ(images_in(damaged_), kDamagedImages);
        EXPECT_FALSE(fs::exists(repaired_));
        EXPECT_THAT(entries_of_others(session_), ElementsAre("photographs", "users.json"));
        EXPECT_TRUE(fs::exists(session_ / "photographs/1/a.jpg"));
        EXPECT_THAT(entries_of_others(damaged_), IsEmpty());
    }

    TemporaryFolder folder_;
    fs::path session_ = folder_.path() / "session";
    fs::path repaired_ = folder_.path() / "session.repairing";
    fs::path damaged_ = folder_.path() / "session.damaged";
};

TEST_F(ReplaceDatabase, LeavesAllElseWhereItIs) {
    EXPECT_FALSE(is_replacing(repaired_));
    ASSERT_TRUE(replace().ok());
    expect_replaced();
}

TEST_F(ReplaceDatabase, GoesOnWithoutTheDatabaseThatWasSetAside) {
    fs::rename(session_ / kDatabaseFolder, repaired_ / kReplacedDatabaseFolder);
    EXPECT_TRUE(is_replacing(repaired_));
    EXPECT_EQ(SessionStore::open(session_, {}).error().code, ErrorCode::kDamaged);
    EXPECT_TRUE(fs::exists(session_ / kDatabaseFolder)) << "RocksDB has looked for it";
    ASSERT_TRUE(replace().ok());
    expect_replaced();
}

TEST_F(ReplaceDatabase, GoesOnWithTheNewDatabaseInItsPlace) {
    fs::rename(session_ / kDatabaseFolder, repaired_ / kReplacedDatabaseFolder);
    fs::rename(repaired_ / kDatabaseFolder, session_ / kDatabaseFolder);
    EXPECT_TRUE(is_replacing(repaired_));
    ASSERT_TRUE(replace().ok());
    expect_replaced();
}

TEST_F(ReplaceDatabase, MendsTheMarker) {
    std::ofstream(session_ / kMarkerFile) << "psfm sess";
    ASSERT_TRUE(replace().ok());
    expect_replaced();
}

TEST_F(ReplaceDatabase, OverwritesNothing) {
    fs::create_directories(damaged_ / "somebody's own");
    EXPECT_EQ(replace().error().code, ErrorCode::kIo);
    EXPECT_EQ(images_in(session_), kRepairedImages);
    EXPECT_TRUE(fs::exists(damaged_ / "somebody's own"));
    EXPECT_TRUE(is_replacing(repaired_));
    fs::remove_all(damaged_);
    ASSERT_TRUE(replace().ok());
    expect_replaced();
}

TEST_F(ReplaceDatabase, TakesNoDatabaseThatSomebodyHasPutThere) {
    fs::rename(session_ / kDatabaseFolder, repaired_ / kReplacedDatabaseFolder);
    make(folder_.path() / "copy", 2);
    fs::rename(folder_.path() / "copy" / kDatabaseFolder, session_ / kDatabaseFolder);
    EXPECT_EQ(replace().error().code, ErrorCode::kIo);
    EXPECT_EQ(images_in(session_), 2U);
    EXPECT_EQ(images_in(repaired_), kRepairedImages);
}

}  // namespace
}  // namespace psfm
