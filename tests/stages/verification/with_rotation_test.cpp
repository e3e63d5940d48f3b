// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/verification/with_rotation.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "tests/stages/verification/two_views.h"

namespace psfm {
namespace {

using test::make_two_views;
using test::TwoViewOptions;
using test::TwoViews;

Eigen::Quaterniond turned(const Eigen::Quaterniond& rotation, double degrees) {
    return Eigen::AngleAxisd(degrees * std::numbers::pi / 180.0,
                             Eigen::Vector3d(1, 2, -1).normalized()) *
           rotation;
}

/// A pair whose matches are right, and whose pose was chosen wrongly among several.
TwoViewGeometry wrongly_posed(const TwoViews& views, double degrees) {
    TwoViewGeometry geometry = *verify_pair(views.matched(), {}, 1);
    geometry.cam2_from_cam1.rotation = turned(geometry.cam2_from_cam1.rotation, degrees);
    geometry.cam2_from_cam1.translation *= -1.0;
    return geometry;
}

TEST(WithRotation, FindsThePoseThatOtherPairsSay) {
    TwoViewOptions options;
    options.matches = 60;
    const TwoViews views = make_two_views(options, 3);
    const TwoViewGeometry wrong = wrongly_posed(views, 120.0);
    // As inexact as averaged rotations are.
    const auto seen =
        with_rotation(wrong, views.matched(), turned(views.cam2_from_cam1.rotation, 3.0), {}, {});
    ASSERT_TRUE(seen.ok()) << seen.error().message;
    EXPECT_EQ(seen->kind, TwoViewKind::kEssential);
    EXPECT_LT(test::rotation_error_deg(seen->cam2_from_cam1, views.cam2_from_cam1), 0.5);
    EXPECT_LT(test::direction_error_deg(seen->cam2_from_cam1, views.cam2_from_cam1), 3.0);
    EXPECT_GE(seen->inliers.size() * 10, wrong.inliers.size() * 9);
    EXPECT_GT(seen->median_angle_deg, 5.0);
}

TEST(WithRotation, RefusesARotationThatTheMatchesContradict) {
    const TwoViews views = make_two_views({}, 4);
    const TwoViewGeometry pair = *verify_pair(views.matched(), {}, 1);
    for (const double degrees : {25.0, 60.0, 180.0}) {
        const auto seen = with_rotation(pair, views.matched(),
                                        turned(views.cam2_from_cam1.rotation, degrees), {}, {});
        ASSERT_FALSE(seen.ok()) << degrees;
        EXPECT_EQ(seen.error().code, ErrorCode::kDegenerate);
    }
}

TEST(OptionsFor, UnknownFocalLengthsHaveAWiderBound) {
    const VerifyOptions options;
    const Camera known = make_camera(1500, 1000, 1400, FocalSource::kExif);
    const Camera guessed = make_camera(1500, 1000, 1400, FocalSource::kUnknown);
    EXPECT_EQ(options_for(options, known, known).max_error_px, options.max_error_px);
    EXPECT_EQ(options_for(options, known, guessed).max_error_px, options.max_uncalibrated_error_px);
    EXPECT_EQ(options_for(options, guessed, known).max_error_px, options.max_uncalibrated_error_px);
}

}  // namespace
}  // namespace psfm
