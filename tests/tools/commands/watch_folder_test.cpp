// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/watch_folder.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <thread>

namespace psfm {
namespace {

namespace fs = std::filesystem;

TEST(WatchFolder, HandsOnAFileOnceWhenItHasStoppedGrowing) {
    const fs::path folder = fs::temp_directory_path() / ("psfm_watch_" + std::to_string(getpid()));
    fs::create_directories(folder);
    std::ofstream file(folder / "a.jpg");
    file << "first half" << std::flush;
    WatchFolder watch(folder);
    PhotoFile photo;
    EXPECT_EQ(watch.next(photo), PhotoSource::Next::kLater) << "its size may still change";
    file << "second half" << std::flush;
    std::this_thread::sleep_for(std::chrono::milliseconds(1100));
    EXPECT_EQ(watch.next(photo), PhotoSource::Next::kLater) << "it has grown";
    std::this_thread::sleep_for(std::chrono::milliseconds(1100));
    ASSERT_EQ(watch.next(photo), PhotoSource::Next::kPhoto);
    EXPECT_EQ(photo.name, "a.jpg");
    std::this_thread::sleep_for(std::chrono::milliseconds(1100));
    EXPECT_EQ(watch.next(photo), PhotoSource::Next::kLater) << "it was handed on";
    fs::remove_all(folder);
}

TEST(WatchFolder, RemembersNothingOfAFileThatIsGone) {
    const fs::path folder = fs::temp_directory_path() / ("psfm_gone_" + std::to_string(getpid()));
    fs::create_directories(folder);
    std::ofstream(folder / "a.jpg") << "as long as before";
    std::ofstream(folder / "b.jpg") << "stays";
    WatchFolder watch(folder);
    PhotoFile photo;
    EXPECT_EQ(watch.next(photo), PhotoSource::Next::kLater);
    fs::remove(folder / "a.jpg");
    std::this_thread::sleep_for(std::chrono::milliseconds(1100));
    ASSERT_EQ(watch.next(photo), PhotoSource::Next::kPhoto);
    EXPECT_EQ(photo.name, "b.jpg");
    std::ofstream(folder / "a.jpg") << "as long as before";
    std::this_thread::sleep_for(std::chrono::milliseconds(1100));
    EXPECT_EQ(watch.next(photo), PhotoSource::Next::kLater) << "it may still grow";
    std::this_thread::sleep_for(std::chrono::milliseconds(1100));
    ASSERT_EQ(watch.next(photo), PhotoSource::Next::kPhoto);
    EXPECT_EQ(photo.name, "a.jpg");
    fs::remove_all(folder);
}

}  // namespace
}  // namespace psfm
