// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/exchange/models/dataset_names.h"

#include <gtest/gtest.h>

namespace psfm {
namespace {

std::vector<std::string> names_of(const std::vector<std::string>& photos) {
    return dataset_names(photos, std::vector<bool>(photos.size(), false));
}

TEST(DatasetNames, AreFlatAndUnique) {
    const std::vector<std::string> photos{"a/x.jpg",     "a_x.jpg",      "a/x.png",
                                          "A/X.JPG",     "IMG.0001.jpg", "IMG.0002.jpg",
                                          "b c/d%e.jpg", ".jpg",         "größe.jpg"};
    const std::vector<std::string> expected{"a_x",      "a_x_2",   "a_x_3", "A_X_4", "IMG_0001",
                                            "IMG_0002", "b_c_d_e", "_jpg",  "größe"};
    EXPECT_EQ(names_of(photos), expected);
}

TEST(DatasetNames, LeaveFileSystemsRoomForEndings) {
    std::string cyrillic;
    for (int i = 0; i < 120; ++i) cyrillic += "ж";
    const std::vector<std::string> photos{
        std::string(200, 'f') + "/" + std::string(200, 'n') + "1.jpg",
        std::string(200, 'f') + "/" + std::string(200, 'n') + "2.jpg", cyrillic + ".jpg"};
    const auto names = names_of(photos);
    EXPECT_NE(names[0], names[1]);
    EXPECT_EQ(names[0].back(), '1');
    for (const std::string& name : names) EXPECT_LE(name.size(), 210U);
    EXPECT_EQ(names[2].substr(0, 2), "ж");  // whole characters
}

TEST(DatasetNames, StayWhenPhotographsAreAdded) {
    std::vector<std::string> photos{"a/x.jpg", "b.jpg"};
    const auto before = names_of(photos);
    photos.insert(photos.end(), {"a_x.jpg", "a_x_2.jpg", "B.jpg"});
    const auto after = names_of(photos);
    EXPECT_TRUE(std::equal(before.begin(), before.end(), after.begin()));
    EXPECT_EQ(after[2], "a_x_2");
    EXPECT_EQ(after[3], "a_x_2_2");
}

TEST(DatasetNames, GoOnWithPhotographsThatComeInAgain) {
    const std::vector<std::string> photos{"a/x.jpg", "a_x.jpg", "a/x.jpg", "a/x.jpg", "a_x.jpg"};
    const std::vector<std::string> expected{"a_x", "a_x_2", "a_x", "a_x", "a_x_3"};
    EXPECT_EQ(dataset_names(photos, {true, false, true, false, false}), expected);
}

}  // namespace
}  // namespace psfm
