// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/console/time_left.h"

#include <gtest/gtest.h>

namespace psfm {
namespace {

TEST(TimeLeft, SaysNothingBeforeItKnows) {
    TimeLeft left(100);
    EXPECT_FALSE(left.seconds(3.0).has_value());
    left.on_photos(1.0, 4);
    EXPECT_FALSE(left.seconds(3.0).has_value());
    left.on_photos(2.0, 5);
    EXPECT_TRUE(left.seconds(3.0).has_value());
    TimeLeft unknown(0);
    unknown.on_photos(1.0, 50);
    EXPECT_FALSE(unknown.seconds(1.0).has_value());
}

TEST(TimeLeft, OfASteadyRunIsWithinAQuarterFromAThirdOn) {
    // 600 photographs at half a second each, the first hundred faster; 25 s of settling.
    TimeLeft left(600);
    double now = 0.0;
    const double streaming = 100 * 0.3 + 500 * 0.5;
    const double end = streaming + 25.0;
    for (std::size_t done = 1; done <= 600; ++done) {
        now += done <= 100 ? 0.3 : 0.5;
        left.on_photos(now, done);
        if (done >= 200) {
            const double truth = end - now;
            EXPECT_NEAR(*left.seconds(now), truth, 0.25 * truth) << done;
        }
    }
    left.on_settling(now, 400);
    const double settling = *left.seconds(now);
    EXPECT_NEAR(settling, 25.0, 0.25 * 25.0);
    left.on_settled(now + 10.0, 200);
    EXPECT_NEAR(*left.seconds(now + 10.0), 0.5 * settling, 1e-9);
    left.on_settled(now + 20.0, 200);
    EXPECT_NEAR(*left.seconds(now + 20.0), 0.0, 1e-9);
}

TEST(TimeLeft, FallsWhileTheLastOfSeveralModelsSettles) {
    TimeLeft left(100);
    for (std::size_t done = 1; done <= 100; ++done)
        left.on_photos(2.0 * static_cast<double>(done), done);
    left.on_settling(200.0, 100);
    left.on_settled(203.0, 20);
    double before = *left.seconds(203.0);
    for (double now = 204.0; now < 213.0; now += 1.0) {
        EXPECT_LT(*left.seconds(now), before) << now;
        before = *left.seconds(now);
    }
}

TEST(TimeLeft, RateFallsWhileNothingComes) {
    TimeLeft left(100);
    for (std::size_t done = 1; done <= 20; ++done) left.on_photos(static_cast<double>(done), done);
    EXPECT_NEAR(left.rate(20.0), 1.0, 0.1);
    EXPECT_LT(left.rate(60.0), 0.3);
}

TEST(TimeLeft, AWatchedFolderGoesOnAfterItHasSettled) {
    TimeLeft left(0);
    left.on_photos(1.0, 10);
    left.on_settling(2.0, 1);
    EXPECT_TRUE(left.is_settling());
    left.on_photos(5.0, 11);
    EXPECT_FALSE(left.is_settling());
}

}  // namespace
}  // namespace psfm
