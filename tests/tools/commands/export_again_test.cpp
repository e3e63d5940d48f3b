// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// Exports into a folder that has another export, or files of somebody else.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "tests/storage/exchange/example_model.h"
#include "tests/tools/commands/dataset_session.h"
#include "tests/tools/commands/psfm_commands.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;

class ExportAgain : public testing::Test {
  protected:
    /// @return what it said of errors; the exit code goes into exit_code_
    std::string export_to(const fs::path& output, const std::string& format,
                          const std::vector<std::string>& options = {}) {
        std::vector<std::string> arguments{"export", "--session", session_.session(), "--format",
                                           format,   "--output",  output.string()};
        arguments.insert(arguments.end(), options.begin(), options.end());
        testing::internal::CaptureStdout();
        testing::internal::CaptureStderr();
        exit_code_ = test::psfm_command(arguments);
        testing::internal::GetCapturedStdout();
        return testing::internal::GetCapturedStderr();
    }

    /// Whatever the format: it has the photographs.
    void expect_refused(const fs::path& output) {
        for (const char* format : {"dataset", "ply", "colmap-database"}) {
            const std::string refused = export_to(output, format);
            EXPECT_EQ(exit_code_, 3) << output << format;
            EXPECT_NE(refused.find(output.string() + " has the photographs"), std::string::npos)
                << refused;
        }
    }

    fs::path place(const std::string& name) const { return folder_.path() / name; }

    /// Every file, without following links, with its content.
    static std::map<std::string, std::string> state_of(const fs::path& folder) {
        std::map<std::string, std::string> state;
        for (const auto& entry : fs::recursive_directory_iterator(folder)) {
            const std::string name = entry.path().lexically_relative(folder).string();
            if (entry.is_symlink())
                state[name] = "-> " + fs::read_symlink(entry.path()).string();
            else
                state[name] = entry.is_directory() ? "" : test::file_bytes(entry.path());
        }
        return state;
    }

    test::TemporaryFolder folder_;
    test::DatasetSession session_{folder_.path()};
    std::map<std::string, std::string> photos_ = state_of(session_.photo_folder());
    int exit_code_ = 0;
};

// A data set, its pictures removed by hand, and an export whose `images` leads to the photographs.
TEST_F(ExportAgain, PhotographsAreNotOverwrittenThroughALink) {
    const fs::path output = place("data");
    export_to(output, "dataset");
    fs::remove_all(output / "0/images");
    export_to(output, "nerfstudio");
    ASSERT_TRUE(fs::is_symlink(output / "0/images"));
    EXPECT_EQ(export_to(output, "dataset"), "");
    EXPECT_EQ(exit_code_, 0);
    EXPECT_EQ(state_of(session_.photo_folder()), photos_);
    EXPECT_FALSE(fs::is_symlink(output / "0/images"));
    EXPECT_TRUE(fs::exists(output / "0/images/five.jpg"));
}

TEST_F(ExportAgain, PicturesDoNotGoBesideThePhotographs) {
    const fs::path output = place("data");
    export_to(output, "nerfstudio");
    ASSERT_TRUE(fs::is_symlink(output / "0/images"));
    EXPECT_EQ(export_to(output, "dataset", {"--max-size", "200"}), "");
    EXPECT_EQ(exit_code_, 0);
    EXPECT_EQ(state_of(session_.photo_folder()), photos_);
    export_to(place("fresh"), "dataset", {"--max-size", "200"});
    EXPECT_EQ(state_of(output), state_of(place("fresh")));
}

// A list that names the link, and pictures that were there before it.
TEST_F(ExportAgain, PhotographsAreNotRemovedThroughALink) {
    for (const char* format : {"colmap", "dataset"}) {
        const fs::path output = place(format);
        export_to(output, "nerfstudio");
        std::string list = test::file_bytes(output / ".psfm-export");
        for (const char* name : {"five.jpg", "drawn.png", "a/photo.jpg", "../../photos/six.jpg"})
            list += std::string("0/images/") + name + "\n";
        test::put_file(output / ".psfm-export", list);
        export_to(output, format);
        EXPECT_EQ(exit_code_, 0);
        EXPECT_EQ(state_of(session_.photo_folder()), photos_);
        EXPECT_FALSE(fs::is_symlink(output / "0/images"));
    }
}

TEST_F(ExportAgain, AnotherFormatReplacesTheEarlierOneWhole) {
    const std::vector<std::string> formats{"colmap", "nerfstudio", "dataset", "ply", "nvm"};
    for (const std::string& format : formats) {
        export_to(place("alone") / format, format);
        ASSERT_EQ(exit_code_, 0) << format;
    }
    for (const std::string& first : formats) {
        for (const std::string& second : formats) {
            const fs::path output = place(first + "-" + second);
            export_to(output, first);
            test::put_file(output / "0/notes.txt", "mine");
            EXPECT_EQ(export_to(output, second), "") << first << ' ' << second;
            EXPECT_EQ(exit_code_, 0) << first << ' ' << second;
            auto expected = state_of(place("alone") / second);
            expected["0"] = "";
            expected["0/notes.txt"] = "mine";
            EXPECT_EQ(state_of(output), expected) << first << ' ' << second;
        }
    }
    EXPECT_EQ(state_of(session_.photo_folder()), photos_);
}

TEST_F(ExportAgain, LinksOfOthersStopIt) {
    for (const char* link : {"0", "0/images", "0/images_2", "0/sparse", "0/stereo"}) {
        const fs::path output = place("data");
        fs::remove_all(output);
        fs::remove_all(place("elsewhere"));
        fs::create_directories((output / link).parent_path());
        fs::create_directory(place("elsewhere"));
        fs::create_directory_symlink(place("elsewhere"), output / link);
        const std::string refused = export_to(output, "dataset", {"--reduced", "2"});
        EXPECT_EQ(exit_code_, 3) << link;
        EXPECT_NE(refused.find((output / link).string() + " is a link that was not made by psfm"),
                  std::string::npos)
            << refused;
        EXPECT_TRUE(fs::is_empty(place("elsewhere"))) << link;
    }
}

TEST_F(ExportAgain, NothingGoesAmongThePhotographs) {
    const fs::path photos = session_.photo_folder();
    for (const fs::path& output : {photos, photos / "a", photos / "." / ""}) expect_refused(output);
    EXPECT_EQ(state_of(photos), photos_);
    testing::internal::CaptureStderr();
    EXPECT_EQ(test::psfm_command({"run", photos.string(), "--session", place("new").string(),
                                  "--dataset", photos.string()}),
              3);
    EXPECT_NE(testing::internal::GetCapturedStderr().find("has the photographs"),
              std::string::npos);
    EXPECT_FALSE(fs::exists(place("new")));
    // Below them, in a folder of its own, it is passed over.
    export_to(photos / "train", "dataset");
    EXPECT_EQ(exit_code_, 0);
}

TEST_F(ExportAgain, NothingGoesAmongThePhotographsOfEarlierRuns) {
    const fs::path photos = session_.photo_folder();
    fs::create_directory(place("second card"));
    session_.run_of(place("second card"));
    for (const fs::path& output : {photos, photos / "a", place("second card")})
        expect_refused(output);
    EXPECT_EQ(state_of(photos), photos_);
    export_to(photos / "train", "ply");
    EXPECT_EQ(exit_code_, 0);
}

TEST_F(ExportAgain, PhotographsOfEarlierFoldersAreFound) {
    fs::create_directory(place("second card"));
    fs::rename(session_.photo_folder() / "drawn.png", place("second card/drawn.png"));
    session_.run_of(place("second card"));
    EXPECT_EQ(export_to(place("data"), "dataset"), "");
    EXPECT_EQ(exit_code_, 0);
    for (const char* name : {"drawn.png", "five.jpg"})
        EXPECT_TRUE(fs::exists(place("data/0/images") / name)) << name;
    // One link leads to the folder that has most.
    const std::string said = export_to(place("linked"), "nerfstudio");
    EXPECT_NE(said.find("1 photograph is not in " + session_.photo_folder().string()),
              std::string::npos)
        << said;
}

TEST_F(ExportAgain, WhatOthersPutAmongPicturesIsNamed) {
    const fs::path output = place("data");
    export_to(output, "dataset");
    test::put_file(output / "0/images/mine.txt", "mine");
    const auto before = state_of(output);
    const std::string refused = export_to(output, "nerfstudio");
    EXPECT_EQ(exit_code_, 3);
    EXPECT_NE(refused.find("0/images/mine.txt was not written by psfm"), std::string::npos)
        << refused;
    EXPECT_EQ(state_of(output), before);
    EXPECT_EQ(export_to(output, "colmap"), "");
    EXPECT_EQ(test::file_bytes(output / "0/images/mine.txt"), "mine");
    EXPECT_FALSE(fs::exists(output / "0/images/five.jpg"));
}

}  // namespace
}  // namespace psfm
