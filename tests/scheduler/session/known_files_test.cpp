// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/session/known_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "scheduler/session/file_stamp.h"
#include "stages/features/photographs/photo_listing.h"
#include "stages/features/photographs/read_file_bytes.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Files with texts instead of pictures: only their bytes matter here.
class KnownFilesTest : public ::testing::Test {
  protected:
    KnownFilesTest()
        : folder_(fs::temp_directory_path() / ("psfm_known_files_" + std::to_string(getpid()))) {
        fs::remove_all(folder_);
        fs::create_directories(folder_);
    }
    ~KnownFilesTest() override { fs::remove_all(folder_); }

    void write(const std::string& name, const std::string& text) const {
        fs::create_directories((folder_ / name).parent_path());
        std::ofstream(folder_ / name) << text;
    }

    /// The session takes in all of a folder, as `run` does.
    void take_in(const fs::path& folder) {
        const auto listing = list_photos(folder);
        ASSERT_TRUE(listing.ok());
        for (const PhotoFile& photo : listing->photos) accept(photo);
    }
    void accept(const PhotoFile& photo) {
        Image image;
        image.id = static_cast<ImageId>(images_.size());
        image.name = photo.name;
        image.metadata.content_hash = *content_hash_of(photo, 1 << 20U);
        images_.push_back(image);
        sources_.push_back({file_of(photo, *stamp_of(photo.path)), {}, 0});
    }

    KnownFiles compare(const fs::path& folder) {
        const auto listing = list_photos(folder);
        EXPECT_TRUE(listing.ok());
        KnownFiles known = compare_with_session(images_, sources_, listing->photos, folder, folder);
        for (const SourcedImage& moved : known.moved) {
            images_[index_of(moved.image.id)] = moved.image;
            sources_[index_of(moved.image.id)] = moved.source;
        }
        return known;
    }
    /// Where there is nothing to tell and nothing new.
    void expect_at_rest(const fs::path& folder) {
        const KnownFiles known = compare(folder);
        EXPECT_THAT(known.told, IsEmpty());
        EXPECT_THAT(known.moved, IsEmpty());
        for (const PhotoFile& photo : known.photos) {
            EXPECT_TRUE(std::ranges::any_of(images_, [&](const Image& image) {
                return image.name == photo.name;
            })) << photo.name;
        }
    }

    std::vector<std::string> names() const {
        std::vector<std::string> names;
        for (const Image& image : images_) names.push_back(image.name);
        return names;
    }
    static std::vector<std::string> names(const KnownFiles& known) {
        std::vector<std::string> names;
        for (const PhotoFile& photo : known.photos) names.push_back(photo.name);
        return names;
    }

    fs::path folder_;
    std::vector<Image> images_;
    std::vector<ImageSource> sources_;
};

TEST_F(KnownFilesTest, NothingHappensWhereNothingHasChanged) {
    write("a.jpg", "A");
    write("b.jpg", "B");
    take_in(folder_);
    expect_at_rest(folder_);
    write("c.jpg", "C is new");
    const KnownFiles known = compare(folder_);
    EXPECT_THAT(names(known), ElementsAre("a.jpg", "b.jpg", "c.jpg"));
    EXPECT_THAT(known.told, IsEmpty());
}

TEST_F(KnownFilesTest, NamesFollowFilesThatWereMovedOrRenamed) {
    write("a.jpg", "A");
    write("b.jpg", "B");
    write("c.jpg", "C");
    take_in(folder_);
    fs::create_directories(folder_ / "sub");
    fs::rename(folder_ / "a.jpg", folder_ / "sub/a.jpg");
    fs::rename(folder_ / "b.jpg", folder_ / "z.jpg");
    const KnownFiles known = compare(folder_);
    EXPECT_THAT(names(), ElementsAre("sub/a.jpg", "z.jpg", "c.jpg"));
    ASSERT_EQ(known.told.size(), 1U);
    EXPECT_THAT(known.told[0],
                HasSubstr("2 photographs were moved or renamed, and the session follows: a.jpg is "
                          "now sub/a.jpg, b.jpg is now z.jpg"));
    expect_at_rest(folder_);
}

TEST_F(KnownFilesTest, NamesThatChangePlacesAreFollowed) {
    write("1.jpg", "A");
    write("2.jpg", "B");
    write("3.jpg", "C");
    take_in(folder_);
    fs::rename(folder_ / "3.jpg", folder_ / "4.jpg");  // as a program that numbers anew does
    fs::rename(folder_ / "2.jpg", folder_ / "3.jpg");
    fs::rename(folder_ / "1.jpg", folder_ / "2.jpg");
    compare(folder_);
    EXPECT_THAT(names(), ElementsAre("2.jpg", "3.jpg", "4.jpg"));
    fs::rename(folder_ / "2.jpg", folder_ / "swap");
    fs::rename(folder_ / "4.jpg", folder_ / "2.jpg");
    fs::rename(folder_ / "swap", folder_ / "4.jpg");
    compare(folder_);
    EXPECT_THAT(names(), ElementsAre("4.jpg", "3.jpg", "2.jpg"));
    expect_at_rest(folder_);
}

TEST_F(KnownFilesTest, SessionsThatKnowNothingOfTheirFilesLearnIt) {
    write("a.jpg", "A");
    write("b.jpg", "B");
    take_in(folder_);
    for (ImageSource& source : sources_) source = {};
    fs::rename(folder_ / "b.jpg", folder_ / "c.jpg");
    EXPECT_EQ(compare(folder_).moved.size(), 2U);
    EXPECT_THAT(names(), ElementsAre("a.jpg", "c.jpg"));
    EXPECT_NE(sources_[0].file.modified_ns, 0);
    expect_at_rest(folder_);
}

TEST_F(KnownFilesTest, CopiesAreLeftToTheSessionToReject) {
    write("a.jpg", "A");
    take_in(folder_);
    write("copy.jpg", "A");
    const KnownFiles known = compare(folder_);
    EXPECT_THAT(names(), ElementsAre("a.jpg"));
    EXPECT_THAT(names(known), ElementsAre("a.jpg", "copy.jpg"));
}

TEST_F(KnownFilesTest, AFileThatCannotBeLookedAtIsNotGone) {
    write("a.jpg", "A");
    take_in(folder_);
    fs::create_symlink("loop", folder_ / "loop");  // as without permission, for root too
    sources_[0].file.folder = (folder_ / "loop").string();
    fs::rename(folder_ / "a.jpg", folder_ / "copy.jpg");
    const KnownFiles known = compare(folder_);
    EXPECT_THAT(known.moved, IsEmpty());
    EXPECT_THAT(known.told, IsEmpty());
}

TEST_F(KnownFilesTest, ASecondCardsPhotographsGetNamesOfTheirOwn) {
    for (const std::string name : {"1.jpg", "2.jpg"}) {
        write("cardA/" + name, "A" + name);
        write("cardB/" + name, "B" + name);
    }
    write("cardB/3.jpg", "B3.jpg");
    take_in(folder_ / "cardA");
    KnownFiles known = compare(folder_ / "cardB/");
    EXPECT_THAT(names(known), ElementsAre("cardB/1.jpg", "cardB/2.jpg", "3.jpg"));
    ASSERT_EQ(known.told.size(), 1U);
    EXPECT_THAT(known.told[0], HasSubstr("2 photographs have the names of others"));
    EXPECT_THAT(known.told[0], HasSubstr("taken in as cardB/1.jpg, cardB/2.jpg"));
    for (const PhotoFile& photo : known.photos) accept(photo);
    EXPECT_EQ(sources_[2].file.folder, folder_.string());
    expect_at_rest(folder_ / "cardB");
    expect_at_rest(folder_ / "cardA");
    // Both cards together: every name is that of the file again.
    compare(folder_);
    EXPECT_THAT(names(), ElementsAre("cardA/1.jpg", "cardA/2.jpg", "cardB/1.jpg", "cardB/2.jpg",
                                     "cardB/3.jpg"));
    expect_at_rest(folder_);
}

TEST_F(KnownFilesTest, OnePhotographWithTheNameOfAnotherIsToldOfAsOne) {
    write("cardA/1.jpg", "A");
    write("cardB/1.jpg", "B");
    take_in(folder_ / "cardA");
    const KnownFiles known = compare(folder_ / "cardB");
    ASSERT_EQ(known.told.size(), 1U);
    EXPECT_THAT(known.told[0], HasSubstr("1 photograph has the name of another one in the session, "
                                         "and is taken in as cardB/1.jpg; programs that look for "
                                         "it by that name want the folder"));
}

TEST_F(KnownFilesTest, EditedPhotographsAreToldOfEveryTime) {
    write("a.jpg", "A");
    write("b.jpg", "B");
    take_in(folder_);
    write("a.jpg", "A, edited");
    for (int i = 0; i < 2; ++i) {
        const KnownFiles known = compare(folder_);
        EXPECT_THAT(names(known), ElementsAre("b.jpg"));
        ASSERT_EQ(known.told.size(), 1U);
        EXPECT_THAT(known.told[0], HasSubstr("1 photograph is not what the session has under that "
                                             "name (edited, or others), and is not taken in: "
                                             "a.jpg"));
    }
}

TEST_F(KnownFilesTest, ACardWithTheSamePathIsToldOfEveryTime) {
    write("card/1.jpg", "A");
    take_in(folder_ / "card");
    fs::remove_all(folder_ / "card");
    write("card/1.jpg", "another");
    for (int i = 0; i < 2; ++i) EXPECT_EQ(compare(folder_ / "card").told.size(), 1U);
}

TEST_F(KnownFilesTest, AMovedFolderIsTheSame) {
    write("old/a.jpg", "A");
    write("old/b.jpg", "B");
    take_in(folder_ / "old");
    fs::rename(folder_ / "old", folder_ / "new");
    const KnownFiles known = compare(folder_ / "new");
    EXPECT_THAT(known.told, IsEmpty());
    EXPECT_EQ(known.moved.size(), 2U);
    EXPECT_EQ(sources_[0].file.folder, (folder_ / "new").string());
    expect_at_rest(folder_ / "new");
}

TEST_F(KnownFilesTest, NobodyTakesTheNameOfAnImageWhoseFileIsGone) {
    write("a.jpg", "A");
    write("b.jpg", "B");
    take_in(folder_);
    fs::rename(folder_ / "a.jpg", folder_ / "b.jpg");
    const KnownFiles known = compare(folder_);
    EXPECT_THAT(names(), ElementsAre("a.jpg", "b.jpg"));
    ASSERT_EQ(known.told.size(), 1U);
    EXPECT_THAT(known.told[0], HasSubstr("'psfm remove' those first"));
}

TEST_F(KnownFilesTest, RemovedImagesHaveNoNames) {
    write("a.jpg", "A");
    take_in(folder_);
    sources_[0].removed = true;
    write("a.jpg", "edited");
    EXPECT_THAT(names(compare(folder_)), ElementsAre("a.jpg"));
}

}  // namespace
}  // namespace psfm
