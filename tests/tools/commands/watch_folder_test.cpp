// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/session/watch_folder.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <thread>

namespace psfm {
namespace {

namespace fs = std::filesystem;

void say_nothing(const std::string& line) {
    ADD_FAILURE() << line;
}

void wait_for_the_next_look() {
    std::this_thread::sleep_for(std::chrono::milliseconds(1100));
}

TEST(WatchFolder, HandsOnAFileOnceWhenItHasStoppedGrowing) {
    const fs::path folder = fs::temp_directory_path() / ("psfm_watch_" + std::to_string(getpid()));
    fs::create_directories(folder);
    std::ofstream file(folder / "a.jpg");
    file << "first half" << std::flush;
    WatchFolder watch(folder, {}, say_nothing);
    PhotoFile photo;
    EXPECT_EQ(watch.next(photo), PhotoSource::Next::kLater) << "its size may still change";
    file << "second half" << std::flush;
    wait_for_the_next_look();
    EXPECT_EQ(watch.next(photo), PhotoSource::Next::kLater) << "it has grown";
    wait_for_the_next_look();
    ASSERT_EQ(watch.next(photo), PhotoSource::Next::kPhoto);
    EXPECT_EQ(photo.name, "a.jpg");
    wait_for_the_next_look();
    EXPECT_EQ(watch.next(photo), PhotoSource::Next::kLater) << "it was handed on";
    file << "after a pause" << std::flush;
    wait_for_the_next_look();
    EXPECT_EQ(watch.next(photo), PhotoSource::Next::kLater) << "it grows again";
    wait_for_the_next_look();
    EXPECT_EQ(watch.next(photo), PhotoSource::Next::kPhoto) << "it is another file now";
    fs::remove_all(folder);
}

TEST(WatchFolder, RemembersNothingOfAFileThatIsGone) {
    const fs::path folder = fs::temp_directory_path() / ("psfm_gone_" + std::to_string(getpid()));
    fs::create_directories(folder);
    std::ofstream(folder / "a.jpg") << "as long as before";
    std::ofstream(folder / "b.jpg") << "stays";
    WatchFolder watch(folder, {}, say_nothing);
    PhotoFile photo;
    EXPECT_EQ(watch.next(photo), PhotoSource::Next::kLater);
    fs::remove(folder / "a.jpg");
    wait_for_the_next_look();
    ASSERT_EQ(watch.next(photo), PhotoSource::Next::kPhoto);
    EXPECT_EQ(photo.name, "b.jpg");
    std::ofstream(folder / "a.jpg") << "as long as before";
    wait_for_the_next_look();
    EXPECT_EQ(watch.next(photo), PhotoSource::Next::kLater) << "it may still grow";
    wait_for_the_next_look();
    ASSERT_EQ(watch.next(photo), PhotoSource::Next::kPhoto);
    EXPECT_EQ(photo.name, "a.jpg");
    fs::remove_all(folder);
}

TEST(WatchFolder, TellsOnceOfWhatIsNoPhotographAndWaitsForAFolderThatIsAway) {
    const fs::path folder = fs::temp_directory_path() / ("psfm_away_" + std::to_string(getpid()));
    fs::create_directories(folder);
    std::ofstream(folder / "a.jpg") << "stays";
    fs::create_symlink("nowhere", folder / "dangling.jpg");
    std::vector<std::string> told;
    WatchFolder watch(folder, {}, [&](const std::string& line) { told.push_back(line); });
    PhotoFile photo;
    EXPECT_EQ(watch.next(photo), PhotoSource::Next::kLater);
    wait_for_the_next_look();
    EXPECT_EQ(watch.next(photo), PhotoSource::Next::kPhoto);
    ASSERT_EQ(told.size(), 1U);
    EXPECT_EQ(told[0].find("rejected dangling.jpg: "), 0U) << told[0];
    fs::path away = folder;
    away += ".away";
    fs::rename(folder, away);
    for (int look = 0; look < 2; ++look) {
        wait_for_the_next_look();
        EXPECT_EQ(watch.next(photo), PhotoSource::Next::kLater);
    }
    ASSERT_EQ(told.size(), 2U);
    EXPECT_NE(told[1].find("waiting for it"), std::string::npos) << told[1];
    fs::rename(away, folder);
    for (int look = 0; look < 2; ++look) {
        wait_for_the_next_look();
        EXPECT_EQ(watch.next(photo), PhotoSource::Next::kLater) << "it was handed on before";
    }
    fs::remove_all(folder);
}

}  // namespace
}  // namespace psfm
