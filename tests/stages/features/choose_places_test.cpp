// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/sift/choose_places.h"

#include <gtest/gtest.h>

namespace psfm {
namespace {

SiftPlace place(float scale, float x, float y) {
    SiftPlace result;
    result.scale = scale;
    result.x = x;
    result.y = y;
    return result;
}

TEST(ChoosePlacesTest, KeepsTheLargestInOrderWithoutDuplicates) {
    std::vector<SiftPlace> places{place(1, 1, 1), place(3, 2, 2), place(2, 5, 5),
                                  place(2, 4, 5), place(2, 5, 5), place(2, 9, 4)};
    SiftOptions options;
    options.max_features = 4;
    choose_places(options, places);
    ASSERT_EQ(places.size(), 4U);
    EXPECT_EQ(places[0].scale, 3.F);
    EXPECT_EQ(places[1].x, 9.F);
    EXPECT_EQ(places[2].x, 4.F);
    EXPECT_EQ(places[3].x, 5.F);
    choose_places(options, places);
    EXPECT_EQ(places.size(), 4U);
}

TEST(ChoosePlacesTest, NothingOfNothing) {
    std::vector<SiftPlace> places;
    choose_places({}, places);
    EXPECT_TRUE(places.empty());
}

}  // namespace
}  // namespace psfm
