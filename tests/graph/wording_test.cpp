// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "graph/wording.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace psfm {
namespace {

TEST(Counted, OneIsNotMany) {
    EXPECT_EQ(counted(0, "cluster"), "0 clusters");
    EXPECT_EQ(counted(1, "connected part"), "1 connected part");
    EXPECT_EQ(counted(2, "photograph"), "2 photographs");
}

TEST(SomeOf, TheFirstFiveAndHowManyMore) {
    std::vector<std::string> names;
    EXPECT_EQ(some_of(names), "");
    names = {"a"};
    EXPECT_EQ(some_of(names), "a");
    names = {"a", "b", "c", "d", "e"};
    EXPECT_EQ(some_of(names), "a, b, c, d, e");
    names.insert(names.end(), {"f", "g"});
    EXPECT_EQ(some_of(names), "a, b, c, d, e and 2 more");
}

}  // namespace
}  // namespace psfm
