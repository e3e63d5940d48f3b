// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include "storage/exchange/models/exported_model.h"

namespace psfm::test {

/// Bit by bit.
inline void expect_equal(const ExportedModel& a, const ExportedModel& b) {
    EXPECT_EQ(a.cameras, b.cameras);
    ASSERT_EQ(a.images.size(), b.images.size());
    for (std::size_t i = 0; i < a.images.size(); ++i) {
        EXPECT_EQ(a.images[i].id, b.images[i].id);
        EXPECT_EQ(a.images[i].camera_id, b.images[i].camera_id);
        EXPECT_EQ(a.images[i].name, b.images[i].name);
        EXPECT_EQ(a.images[i].cam_from_world.rotation.coeffs(),
                  b.images[i].cam_from_world.rotation.coeffs());
        EXPECT_EQ(a.images[i].cam_from_world.translation, b.images[i].cam_from_world.translation);
        EXPECT_EQ(a.images[i].keypoints, b.images[i].keypoints);
    }
    ASSERT_EQ(a.points.size(), b.points.size());
    for (std::size_t i = 0; i < a.points.size(); ++i) {
        EXPECT_EQ(a.points[i].id, b.points[i].id);
        EXPECT_EQ(a.points[i].position, b.points[i].position);
        EXPECT_EQ(a.points[i].rgb, b.points[i].rgb);
        EXPECT_EQ(a.points[i].error_px, b.points[i].error_px);
        EXPECT_EQ(a.points[i].track, b.points[i].track);
    }
}

}  // namespace psfm::test
