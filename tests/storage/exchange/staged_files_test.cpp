// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/exchange/files/staged_files.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/storage/exchange/example_model.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> kSet{"0/images/a.jpg", "0/images/b.jpg", "0/images/c.jpg",
                                    "0/sparse/cameras.bin", "0/transforms.json"};

void stage_set(StagedFiles& files, const fs::path& folder, const std::string& bytes) {
    for (const std::string& name : kSet) {
        const auto written =
            files.write(folder / name, [&](OutputFile& file) { file.text(bytes); });
        ASSERT_TRUE(written.ok()) << written.error().message;
    }
}

TEST(StagedFiles, NothingIsThereBeforeItIsCommitted) {
    const test::TemporaryFolder folder;
    {
        StagedFiles files(folder.path() / "new");
        stage_set(files, folder.path() / "new", "one");
        EXPECT_FALSE(fs::exists(folder.path() / "new/0"));
    }
    EXPECT_FALSE(fs::exists(folder.path() / "new"));
    StagedFiles files(folder.path());
    stage_set(files, folder.path(), "one");
    files.folder(folder.path() / "0/stereo");
    ASSERT_TRUE(files.commit().ok());
    EXPECT_EQ(test::count_files(folder.path()), kSet.size());
    EXPECT_TRUE(fs::is_directory(folder.path() / "0/stereo"));
    EXPECT_FALSE(fs::exists(folder.path() / kStagingFolder));
}

// What cannot be put into its place stops the commit there, as if the machine had.
TEST(StagedFiles, AHalfSwappedSetDoesNotOpen) {
    for (std::size_t stop = 0; stop < kSet.size(); ++stop) {
        const test::TemporaryFolder folder;
        StagedFiles first(folder.path());
        stage_set(first, folder.path(), "old");
        ASSERT_TRUE(first.commit().ok());
        StagedFiles second(folder.path());
        stage_set(second, folder.path(), "new");
        fs::remove(folder.path() / kSet[stop]);
        test::put_file(folder.path() / kSet[stop] / "in the way", "");
        EXPECT_FALSE(second.commit().ok());
        for (std::size_t n = 0; n < kSet.size(); ++n) {
            if (n == stop) continue;
            const fs::path path = folder.path() / kSet[n];
            if (n < stop)
                EXPECT_EQ(test::file_bytes(path), "new") << path;
            else
                EXPECT_FALSE(fs::exists(path)) << path;
        }
    }
}

TEST(StagedFiles, OneFileIsReplacedInOneStep) {
    const test::TemporaryFolder folder;
    test::put_file(folder.path() / "0.ply", "old");
    StagedFiles files(folder.path());
    ASSERT_TRUE(files.write(folder.path() / "0.ply", [](OutputFile& file) { file.text("new"); }));
    // A folder in its place cannot be replaced, and is not removed before.
    fs::remove(folder.path() / "0.ply");
    fs::create_directory(folder.path() / "0.ply");
    EXPECT_FALSE(files.commit().ok());
    EXPECT_TRUE(fs::exists(folder.path() / "0.ply"));
}

TEST(StagedFiles, NothingIsReachedThroughALink) {
    const test::TemporaryFolder folder;
    const fs::path photos = folder.path() / "photos";
    const fs::path output = folder.path() / "output";
    test::put_file(photos / "a.jpg", "a photograph");
    test::put_file(photos / "b.jpg", "another");
    fs::create_directories(output / "0");
    fs::create_directory_symlink(photos, output / "0/images");
    for (const bool equal : {false, true}) {
        StagedFiles files(output);
        ASSERT_TRUE(files.write(output / "0/images/a.jpg", [&](OutputFile& file) {
            file.text(equal ? "a photograph" : "a picture");
        }));
        files.remove_outdated(output / "0/images/b.jpg");
        const auto refused = files.commit();
        ASSERT_FALSE(refused.ok());
        EXPECT_NE(refused.error().message.find("output/0/images is a link"), std::string::npos)
            << refused.error().message;
        EXPECT_EQ(test::file_bytes(photos / "a.jpg"), "a photograph");
        EXPECT_EQ(test::count_files(photos), 2U);
    }
    // Where the link is outdated it goes, and a folder takes its place.
    StagedFiles files(output);
    ASSERT_TRUE(files.write(output / "0/images/a.jpg",
                            [](OutputFile& file) { file.text("a photograph"); }));
    files.remove_outdated(output / "0/images");
    ASSERT_TRUE(files.commit().ok());
    EXPECT_FALSE(fs::is_symlink(output / "0/images"));
    EXPECT_EQ(test::count_files(output), 1U);
    EXPECT_EQ(test::count_files(photos), 2U);
}

TEST(StagedFiles, FullDiskLeavesTheEarlierFilesAsTheyWere) {
    const test::TemporaryFolder folder;
    test::put_file(folder.path() / "0/images.bin", "old");
    {
        // The temporary goes to a device that is always full.
        fs::create_directories(folder.path() / kStagingFolder / "0");
        fs::create_symlink("/dev/full", folder.path() / kStagingFolder / "0/images.bin");
        StagedFiles files(folder.path());
        const auto failed =
            files.write(folder.path() / "0/images.bin", [](OutputFile& file) { file.text("new"); });
        ASSERT_FALSE(failed.ok());
        EXPECT_EQ(failed.error().code, ErrorCode::kNoSpace);
        EXPECT_NE(failed.error().message.find("0/images.bin"), std::string::npos);
    }
    EXPECT_EQ(test::file_bytes(folder.path() / "0/images.bin"), "old");
    EXPECT_EQ(test::count_files(folder.path()), 1U);
}

}  // namespace
}  // namespace psfm
