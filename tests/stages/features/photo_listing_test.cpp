// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/photographs/photo_listing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/stages/features/photo_fixture.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::TemporaryFolder;

std::vector<std::string> names_of(const PhotoListing& listing) {
    std::vector<std::string> names;
    for (const PhotoFile& photo : listing.photos) names.push_back(photo.name);
    return names;
}

std::vector<std::string> rejected_of(const PhotoListing& listing) {
    std::vector<std::string> names;
    for (const RejectedPath& rejected : listing.rejected) names.push_back(rejected.name);
    return names;
}

std::string failure(const fs::path& folder) {
    const auto listing = list_photos(folder);
    if (listing) return "was listed";
    EXPECT_EQ(listing.error().code, ErrorCode::kNotFound);
    EXPECT_THAT(listing.error().message, HasSubstr(folder.filename().string()));
    return listing.error().message;
}

TEST(PhotoListingTest, SortsByBytesAndKeepsFolders) {
    const TemporaryFolder folder;
    for (const char* name :
         {"b.jpg", "B.JPG", "a/z.png", "a/b/c.TIFF", "a.jpg", "sub/b.jpg", "notes.txt",
          ".hidden.jpg", ".cache/x.jpg", "jpg", "a-1.jpg", "h\xC3\xA4user.webp"}) {
        folder.write(name, "x");
    }
    const auto listing = list_photos(folder.path());
    ASSERT_TRUE(listing) << listing.error().message;
    EXPECT_THAT(names_of(*listing),
                ElementsAre("B.JPG", "a-1.jpg", "a.jpg", "a/b/c.TIFF", "a/z.png", "b.jpg",
                            "h\xC3\xA4user.webp", "sub/b.jpg"));
    EXPECT_TRUE(listing->rejected.empty());
    for (const PhotoFile& photo : listing->photos)
        EXPECT_TRUE(fs::exists(photo.path)) << photo.path;
}

TEST(PhotoListingTest, KnowsTheExtensions) {
    for (const char* name :
         {"a.jpg", "a.JPEG", "a.pNg", "a.tif", "a.TIFF", "a.webp", "a.bmp", "a.HEIC", "a.heif",
          "a.hif", "a.AVIF", "a.jp2", "a.pgm", "a.b.ppm", "a.jfif", "a.JPE", "a.mpo", "a.pnm"}) {
        EXPECT_TRUE(has_photo_extension(name)) << name;
    }
    for (const char* name : {"", "jpg", ".jpg", "a.", "a.txt", "a.jpg.txt", "a.jpgx", "a.gif"}) {
        EXPECT_FALSE(has_photo_extension(name)) << name;
    }
}

TEST(PhotoListingTest, LinksAreSafe) {
    const TemporaryFolder folder;
    const TemporaryFolder outside;
    outside.write("far.jpg", "x");
    folder.write("a.jpg", "x");
    folder.write("sub/b.jpg", "x");
    fs::create_directory_symlink("..", folder.path() / "sub/loop");
    fs::create_directory_symlink(outside.path(), folder.path() / "away");
    fs::create_symlink("self.jpg", folder.path() / "self.jpg");
    fs::create_symlink("nowhere", folder.path() / "broken.jpg");
    fs::create_symlink(outside.path() / "far.jpg", folder.path() / "link.jpg");
    const auto listing = list_photos(folder.path());
    ASSERT_TRUE(listing) << listing.error().message;
    EXPECT_THAT(names_of(*listing), ElementsAre("a.jpg", "link.jpg", "sub/b.jpg"));
    EXPECT_THAT(rejected_of(*listing), ElementsAre("away", "broken.jpg", "self.jpg", "sub/loop"));
}

TEST(PhotoListingTest, RejectsNamesThatCannotBeShownAndWhatIsNoFile) {
    const TemporaryFolder folder;
    folder.write("good.jpg", "x");
    folder.write("two\nlines.jpg", "x");
    folder.write("\xFF.jpg", "x");
    folder.write("\xFF.txt", "x");
    folder.write("\x1B/inside.jpg", "x");
    fs::create_directory(folder.path() / "folder.jpg");
    ASSERT_EQ(::mkfifo((folder.path() / "pipe.jpg").c_str(), 0600), 0);
    const auto listing = list_photos(folder.path());
    ASSERT_TRUE(listing) << listing.error().message;
    EXPECT_THAT(names_of(*listing), ElementsAre("good.jpg"));
    EXPECT_THAT(rejected_of(*listing),
                ElementsAre("\\x1b/inside.jpg", "\\xff.jpg", "pipe.jpg", "two\\x0alines.jpg"));
    for (const RejectedPath& rejected : listing->rejected) EXPECT_FALSE(rejected.reason.empty());
}

TEST(PhotoListingTest, WhatCannotBeLookedAtIsToldWithTheSystemsReason) {
    const TemporaryFolder folder;
    folder.write("a.jpg", "x");
    const std::string too_long(300, 'x');  // refused as without permission, for root too
    fs::create_symlink(too_long, folder.path() / "b.jpg");
    const auto listing = list_photos(folder.path());
    ASSERT_TRUE(listing) << listing.error().message;
    ASSERT_THAT(rejected_of(*listing), ElementsAre("b.jpg"));
    EXPECT_THAT(listing->rejected.front().reason,
                HasSubstr("cannot be looked at (File name too long); give yourself permission"));
}

TEST(PhotoListingTest, FoldersWithoutPhotographsAreErrorsWithARemedy) {
    const TemporaryFolder folder;
    EXPECT_THAT(failure(folder.path()), HasSubstr("holds no photographs; put some into it"));
    folder.write("notes.txt", "x");
    fs::create_symlink("nowhere", folder.path() / "broken.jpg");
    EXPECT_THAT(failure(folder.path()), HasSubstr("1 rejected, the first: broken.jpg"));
    EXPECT_THAT(failure(folder.path() / "gone"),
                HasSubstr("there is no such folder; check the path"));
    EXPECT_THAT(failure(folder.path() / "notes.txt"), HasSubstr("is not a folder"));
    // Cannot be listed by anyone, root included.
    EXPECT_THAT(failure("/proc/self/task/0/fd"), HasSubstr("/proc/self/task/0/fd"));
}

TEST(PhotoListingTest, WhatPsfmHasExportedIsNoPhotograph) {
    const TemporaryFolder folder;
    for (const char* name : {"a.jpg", "train/.psfm-export", "train/0/images/a.jpg", "b/c.jpg"})
        folder.write(name, "x");
    const auto listing = list_photos(folder.path());
    ASSERT_TRUE(listing) << listing.error().message;
    EXPECT_THAT(names_of(*listing), ElementsAre("a.jpg", "b/c.jpg"));
}

TEST(PhotoListingTest, CountsWhatLooksLikePhotographsAndIsNotRead) {
    const TemporaryFolder folder;
    for (const char* name : {"a.avif", "b.MPO", "c.dng", "d.gif", "e.jfif", "f.jpe", "g.mp4",
                             "sub/h.MP4", "i.jpg", "notes.txt", ".hidden.mp4", "j.NEF"})
        folder.write(name, "x");
    const auto listing = list_photos(folder.path());
    ASSERT_TRUE(listing) << listing.error().message;
    EXPECT_THAT(names_of(*listing), ElementsAre("a.avif", "b.MPO", "e.jfif", "f.jpe", "i.jpg"));
    const auto lines = describe(listing->unread);
    ASSERT_EQ(lines.size(), 3U);
    EXPECT_THAT(lines[0], HasSubstr("2 raw photographs (.dng, .nef); develop them"));
    EXPECT_THAT(lines[1], HasSubstr("2 videos (2 .mp4); take frames"));
    EXPECT_THAT(lines[2], HasSubstr("1 picture of a format that is not read (.gif); export"));
    EXPECT_EQ(describe_briefly(listing->unread), "5 files (.dng, .gif, 2 .mp4, .nef)");
}

TEST(PhotoListingTest, AFolderOfVideosSaysWhatToDo) {
    const TemporaryFolder folder;
    folder.write("a.mov", "x");
    EXPECT_THAT(failure(folder.path()), HasSubstr("1 video (.mov); take frames out of them"));
}

}  // namespace
}  // namespace psfm
