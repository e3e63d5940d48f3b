// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/adopt_features.h"

#include <gtest/gtest.h>

namespace psfm {
namespace {

Keypoint at(float x, float y, float scale = 1.F, std::uint8_t red = 0) {
    Keypoint keypoint;
    keypoint.x = x;
    keypoint.y = y;
    keypoint.scale = scale;
    keypoint.red = red;
    return keypoint;
}

/// Row i is full of i + 1.
Descriptors numbered(std::size_t rows) {
    Descriptors descriptors;
    for (std::size_t i = 0; i < rows; ++i)
        descriptors.values.insert(descriptors.values.end(), Descriptors::kSize,
                                  static_cast<std::uint8_t>(i + 1));
    return descriptors;
}

TEST(AdoptFeatures, TheNearestBecomesTheOtherProgramsOwn) {
    const Keypoints places{at(10, 10), at(11, 10), at(50, 50), at(100, 100)};
    const Keypoints found{at(10.9F, 10, 3, 7), at(51, 50.5F, 2, 8), at(70, 70, 5, 9),
                          at(50.2F, 50, 4, 6)};
    const AdoptedFeatures adopted = adopt_features(places, found, numbered(4));
    ASSERT_EQ(adopted.keypoints.size(), 6U);
    EXPECT_EQ(adopted.descriptors.rows(), 6U);
    EXPECT_EQ(adopted.described, 2U);
    // In their order, at their places.
    for (std::size_t i = 0; i < places.size(); ++i)
        EXPECT_EQ(adopted.keypoints[i].position(), places[i].position());
    EXPECT_EQ(adopted.descriptors.row(0)[0], 0);  // the second one is nearer
    EXPECT_EQ(adopted.descriptors.row(1)[5], 1);
    EXPECT_EQ(adopted.keypoints[1].red, 7);
    EXPECT_EQ(adopted.descriptors.row(2)[0], 4);
    EXPECT_EQ(adopted.keypoints[2].scale, 4.F);
    EXPECT_EQ(adopted.descriptors.row(3)[127], 0);
    // Then what is left.
    EXPECT_EQ(adopted.keypoints[4], found[1]);
    EXPECT_EQ(adopted.keypoints[5], found[2]);
    EXPECT_EQ(adopted.descriptors.row(5)[0], 3);
}

TEST(AdoptFeatures, OfNothing) {
    EXPECT_TRUE(adopt_features({}, {}, {}).keypoints.empty());
    const AdoptedFeatures only_found = adopt_features({}, {at(1, 2)}, numbered(1));
    EXPECT_EQ(only_found.keypoints.size(), 1U);
    const AdoptedFeatures only_places = adopt_features({at(1, 2)}, {}, {});
    EXPECT_EQ(only_places.descriptors.rows(), 1U);
    EXPECT_EQ(only_places.described, 0U);
}

}  // namespace
}  // namespace psfm
