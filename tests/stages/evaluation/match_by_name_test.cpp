// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "stages/evaluation/named_pose.h"

namespace psfm {
namespace {

std::vector<NamedPose> named(std::initializer_list<const char*> names) {
    std::vector<NamedPose> poses;
    for (const char* name : names) poses.push_back({name, {}});
    return poses;
}

using NamePairs = std::vector<std::pair<std::string, std::string>>;

NamePairs match(const std::vector<NamedPose>& reference, const std::vector<NamedPose>& model) {
    NamePairs pairs;
    for (const NameMatch& m : match_by_name(reference, model)) {
        pairs.emplace_back(reference[m.reference].name, model[m.model].name);
    }
    return pairs;
}

TEST(MatchByName, WholeNamesInTheOrderOfTheReferencesNames) {
    EXPECT_EQ(match(named({"b.jpg", "a.jpg", "c.jpg"}), named({"c.jpg", "x.jpg", "a.jpg"})),
              (NamePairs{{"a.jpg", "a.jpg"}, {"c.jpg", "c.jpg"}}));
}

TEST(MatchByName, LastPartWhereItIsUnique) {
    EXPECT_EQ(match(named({"images/a.jpg", "images/b.jpg"}), named({"a.jpg", "cam/b.jpg"})),
              (NamePairs{{"images/a.jpg", "a.jpg"}, {"images/b.jpg", "cam/b.jpg"}}));
}

TEST(MatchByName, AmbiguousLastPartsMatchNothing) {
    EXPECT_TRUE(match(named({"left/1.jpg", "right/1.jpg"}), named({"1.jpg"})).empty());
    EXPECT_TRUE(match(named({"1.jpg"}), named({"left/1.jpg", "right/1.jpg"})).empty());
}

TEST(MatchByName, WholeNameGoesBeforeLastPart) {
    EXPECT_EQ(match(named({"left/1.jpg", "right/1.jpg"}), named({"right/1.jpg"})),
              (NamePairs{{"right/1.jpg", "right/1.jpg"}}));
    // "1.jpg" is taken by its equal, so "left/1.jpg" finds nothing.
    EXPECT_EQ(match(named({"1.jpg"}), named({"left/1.jpg", "1.jpg"})),
              (NamePairs{{"1.jpg", "1.jpg"}}));
}

TEST(MatchByName, EmptyLists) {
    EXPECT_TRUE(match({}, named({"a.jpg"})).empty());
    EXPECT_TRUE(match(named({"a.jpg"}), {}).empty());
}

}  // namespace
}  // namespace psfm
