// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "graph/weakness.h"

#include <gtest/gtest.h>

#include <set>

namespace psfm {
namespace {

TEST(Weaknesses, AreASet) {
    Weaknesses found;
    EXPECT_TRUE(found.none());
    found.add(Weakness::kThinJoint);
    found.add(Weakness::kSmallAngles);
    found.add(Weakness::kThinJoint);
    EXPECT_EQ(list_of(found), (std::vector{Weakness::kSmallAngles, Weakness::kThinJoint}));
    EXPECT_FALSE(found.has(Weakness::kFewPoints));
    EXPECT_EQ(list_of({1U << 20U}), std::vector<Weakness>{}) << "of a newer program";
}

TEST(Weaknesses, EachHasItsOwnWords) {
    std::set<std::string> words;
    for (std::uint32_t i = 0; i < kWeaknessCount; ++i) {
        EXPECT_TRUE(words.insert(name_of(static_cast<Weakness>(i))).second);
        EXPECT_TRUE(words.insert(describe(static_cast<Weakness>(i))).second);
    }
    EXPECT_FALSE(words.contains("unknown"));
}

}  // namespace
}  // namespace psfm
