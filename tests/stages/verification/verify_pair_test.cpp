// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/verification/verify_pair.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <set>

#include "stages/algorithms/two_view/decompose_two_view.h"
#include "stages/verification/match_density.h"
#include "tests/stages/verification/two_views.h"

namespace psfm {
namespace {

using test::make_two_views;
using test::Shape;
using test::TwoViewOptions;
using test::TwoViews;

constexpr std::uint64_t kSeed = 42;

bool equal(const TwoViewGeometry& a, const TwoViewGeometry& b) {
    return a.kind == b.kind && a.matrix == b.matrix && a.inliers == b.inliers &&
           a.cam2_from_cam1.translation == b.cam2_from_cam1.translation &&
           a.cam2_from_cam1.rotation.coeffs() == b.cam2_from_cam1.rotation.coeffs() &&
           a.median_angle_deg == b.median_angle_deg;
}

/// Nearly all true matches, hardly a wrong one, in order, each feature once a side.
void expect_good_inliers(const TwoViews& views, const TwoViewGeometry& geometry) {
    const std::vector<FeatureMatch>& inliers = geometry.inliers;
    const std::size_t wrong = test::wrong_inliers(views, inliers);
    EXPECT_GE(inliers.size() - wrong, test::true_count(views) * 95 / 100);
    EXPECT_LE(wrong, 6U);
    EXPECT_TRUE(std::ranges::is_sorted(inliers));
}

TEST(VerifyPair, GeneralSceneOfKnownCameras) {
    for (const std::uint64_t scene : {1U, 2U, 3U, 4U, 5U}) {
        const TwoViews views = make_two_views({}, scene);
        const Result<TwoViewGeometry> geometry = verify_pair(views.matched(), {}, kSeed);
        ASSERT_TRUE(geometry.ok()) << geometry.error().message;
        EXPECT_EQ(geometry->kind, TwoViewKind::kEssential);
        EXPECT_LT(test::rotation_error_deg(geometry->cam2_from_cam1, views.cam2_from_cam1), 0.15);
        EXPECT_LT(test::direction_error_deg(geometry->cam2_from_cam1, views.cam2_from_cam1), 0.5);
        EXPECT_NEAR(geometry->cam2_from_cam1.translation.norm(), 1.0, 1e-9);
        EXPECT_NEAR(geometry->matrix.norm(), 1.0, 1e-9);
        EXPECT_NEAR(geometry->median_angle_deg, 12.0, 3.0);
        expect_good_inliers(views, *geometry);
    }
}

TEST(VerifyPair, SaysHowDenselyTheInliersMatch) {
    const TwoViews views = make_two_views({}, 1);
    const Result<TwoViewGeometry> geometry = verify_pair(views.matched(), {}, kSeed);
    ASSERT_TRUE(geometry.ok()) << geometry.error().message;
    const MatchDensity density = match_density(views.matched(), geometry->inliers);
    EXPECT_GT(density.shared, 0.0);
    EXPECT_EQ(geometry->match_density, density.shared);
    EXPECT_EQ(geometry->core_density, density.core);
}

TEST(VerifyPair, DifferentCamerasWithDistortion) {
    TwoViewOptions options;
    options.camera1.params[3] = -0.12;
    options.camera2 = make_camera(2000, 1500, 2600, FocalSource::kExif);
    options.camera2.params[3] = 0.08;
    const TwoViews views = make_two_views(options, 7);
    const Result<TwoViewGeometry> geometry = verify_pair(views.matched(), {}, kSeed);
    ASSERT_TRUE(geometry.ok()) << geometry.error().message;
    EXPECT_EQ(geometry->kind, TwoViewKind::kEssential);
    EXPECT_LT(test::rotation_error_deg(geometry->cam2_from_cam1, views.cam2_from_cam1), 0.15);
    expect_good_inliers(views, *geometry);
}

TEST(VerifyPair, PlaneWithKnownCameras) {
    TwoViewOptions options;
    options.shape = Shape::kPlane;
    const TwoViews views = make_two_views(options, 8);
    const Result<TwoViewGeometry> geometry = verify_pair(views.matched(), {}, kSeed);
    ASSERT_TRUE(geometry.ok()) << geometry.error().message;
    EXPECT_EQ(geometry->kind, TwoViewKind::kPlanar);
    EXPECT_LT(test::rotation_error_deg(geometry->cam2_from_cam1, views.cam2_from_cam1), 0.5);
    EXPECT_LT(test::direction_error_deg(geometry->cam2_from_cam1, views.cam2_from_cam1), 2.0);
    expect_good_inliers(views, *geometry);
    // The matrix is the homography.
    for (std::size_t i = 0; i < views.matches.size(); ++i) {
        if (!views.is_true[i]) continue;
        const Eigen::Vector2d mapped =
            (geometry->matrix * views.keypoints1[i].position().homogeneous()).hnormalized();
        EXPECT_LT((mapped - views.keypoints2[i].position()).norm(), 4.0);
    }
}

TEST(VerifyPair, PlanesOfCoarseMatchesAreFoundAsSurely) {
    // A homography from four coarse matches has far fewer inliers than the best one.
    TwoViewOptions options;
    options.shape = Shape::kPlane;
    options.noise_px = 0.7;
    std::uint32_t planar = 0;
    for (std::uint64_t scene = 1; scene <= 40; ++scene) {
        const TwoViews views = make_two_views(options, scene);
        const Result<TwoViewGeometry> geometry = verify_pair(views.matched(), {}, kSeed + scene);
        if (geometry.ok() && geometry->kind == TwoViewKind::kPlanar) ++planar;
    }
    EXPECT_GE(planar, 39U);
}

TEST(VerifyPair, PureRotation) {
    for (const FocalSource source : {FocalSource::kGiven, FocalSource::kUnknown}) {
        TwoViewOptions options;
        options.turn_only = true;
        options.camera1.focal_source = options.camera2.focal_source = source;
        TwoViews views = make_two_views(options, 9);
        // Unknown focal lengths are guessed, a fifth too long.
        const double factor = source == FocalSource::kUnknown ? 1.2 : 1.0;
        views.camera1.params[0] *= factor;
        views.camera2.params[0] *= factor;
        const Result<TwoViewGeometry> geometry = verify_pair(views.matched(), {}, kSeed);
        ASSERT_TRUE(geometry.ok()) << geometry.error().message;
        EXPECT_EQ(geometry->kind, TwoViewKind::kPureRotation);
        EXPECT_EQ(geometry->cam2_from_cam1.translation.norm(), 0.0);
        EXPECT_EQ(geometry->median_angle_deg, 0.0);
        const double allowed = source == FocalSource::kUnknown ? 3.0 : 0.1;
        EXPECT_LT(test::rotation_error_deg(geometry->cam2_from_cam1, views.cam2_from_cam1),
                  allowed);
        expect_good_inliers(views, *geometry);
    }
}

TEST(VerifyPair, UnknownFocalLengthGivesAFundamentalMatrix) {
    TwoViews views = make_two_views({}, 10);
    const Eigen::Matrix3d truth = fundamental_from_pose(
        views.cam2_from_cam1, {views.camera1.matrix(), views.camera2.matrix()});
    views.camera2.params[0] = 1800;
    views.camera2.focal_source = FocalSource::kUnknown;
    const Result<TwoViewGeometry> geometry = verify_pair(views.matched(), {}, kSeed);
    ASSERT_TRUE(geometry.ok()) << geometry.error().message;
    EXPECT_EQ(geometry->kind, TwoViewKind::kFundamental);
    expect_good_inliers(views, *geometry);
    const double sign = geometry->matrix.cwiseProduct(truth).sum() < 0 ? -1.0 : 1.0;
    // Compared where the points are, not by elements, whose scales differ.
    const Eigen::Vector3d centre(750, 500, 1);
    const Eigen::Vector3d line = sign * geometry->matrix * centre;
    const Eigen::Vector3d true_line = truth * centre;
    EXPECT_LT((line.head<2>().normalized() - true_line.head<2>().normalized()).norm(), 0.01);
}

TEST(VerifyPair, TooFewMatches) {
    for (const int count : {0, 1, 4, 5, 7, 14}) {
        TwoViewOptions options;
        options.matches = count;
        const TwoViews views = make_two_views(options, 11);
        const Result<TwoViewGeometry> geometry = verify_pair(views.matched(), {}, kSeed);
        ASSERT_FALSE(geometry.ok());
        EXPECT_EQ(geometry.error().code, ErrorCode::kTooFewMatches);
    }
}

TEST(VerifyPair, WrongMatchesAreNoPair) {
    TwoViewOptions options;
    options.wrong = 1.0;
    for (const FocalSource source : {FocalSource::kGiven, FocalSource::kUnknown}) {
        options.camera1.focal_source = source;
        const TwoViews views = make_two_views(options, 12);
        const Result<TwoViewGeometry> geometry = verify_pair(views.matched(), {}, kSeed);
        ASSERT_FALSE(geometry.ok());
        EXPECT_EQ(geometry.error().code, ErrorCode::kDegenerate);
    }
}

/// Points on a line determine neither pose nor homography, however well they fit one.
TEST(VerifyPair, CollinearPointsAreNoPair) {
    for (const FocalSource source : {FocalSource::kGiven, FocalSource::kUnknown}) {
        for (const double noise : {0.0, 0.5}) {
            TwoViewOptions options;
            options.shape = Shape::kLine;
            options.noise_px = noise;
            options.wrong = 0;
            options.camera1.focal_source = source;
            const TwoViews views = make_two_views(options, 13);
            const Result<TwoViewGeometry> geometry = verify_pair(views.matched(), {}, kSeed);
            ASSERT_FALSE(geometry.ok());
            EXPECT_EQ(geometry.error().code, ErrorCode::kDegenerate);
        }
    }
}

TEST(VerifyPair, IdenticalPointsAreNoPair) {
    TwoViews views = make_two_views({}, 14);
    for (Keypoint& keypoint : views.keypoints1) keypoint = views.keypoints1.front();
    for (Keypoint& keypoint : views.keypoints2) keypoint = views.keypoints2.front();
    const Result<TwoViewGeometry> geometry = verify_pair(views.matched(), {}, kSeed);
    ASSERT_FALSE(geometry.ok());
    EXPECT_EQ(geometry.error().code, ErrorCode::kDegenerate);
}

TEST(VerifyPair, RepeatsBitForBitInAnyOrderOfMatches) {
    TwoViews views = make_two_views({}, 15);
    const Result<TwoViewGeometry> once = verify_pair(views.matched(), {}, kSeed);
    std::ranges::reverse(views.matches);
    const Result<TwoViewGeometry> again = verify_pair(views.matched(), {}, kSeed);
    ASSERT_TRUE(once.ok() && again.ok());
    EXPECT_TRUE(equal(*once, *again));
}

TEST(VerifyPair, EachFeatureAtMostOnceASide) {
    TwoViews views = make_two_views({}, 16);
    // Every feature of image 2 gets a twin at the same place, matched by the same feature of
    // image 1.
    const std::size_t count = views.matches.size();
    for (std::uint32_t i = 0; i < count; ++i) {
        views.keypoints2.push_back(views.keypoints2[i]);
        views.matches.push_back({i, static_cast<std::uint32_t>(count) + i});
    }
    const Result<TwoViewGeometry> geometry = verify_pair(views.matched(), {}, kSeed);
    ASSERT_TRUE(geometry.ok()) << geometry.error().message;
    std::set<std::uint32_t> seen1;
    std::set<std::uint32_t> seen2;
    for (const FeatureMatch& match : geometry->inliers) {
        EXPECT_TRUE(seen1.insert(match.first).second);
        EXPECT_TRUE(seen2.insert(match.second).second);
    }
}

TEST(VerifyPair, NamesBadInput) {
    TwoViews views = make_two_views({}, 17);
    VerifyOptions options;
    options.max_error_px = 0;
    EXPECT_EQ(verify_pair(views.matched(), options, kSeed).error().code,
              ErrorCode::kInvalidArgument);
    views.matches.push_back({100000, 0});
    EXPECT_EQ(verify_pair(views.matched(), {}, kSeed).error().code, ErrorCode::kInvalidArgument);
    views.matches.pop_back();
    views.camera1.width = 0;
    EXPECT_EQ(verify_pair(views.matched(), {}, kSeed).error().code, ErrorCode::kInvalidArgument);
}

TEST(WithIntrinsics, RightFocalLengthTurnsAFundamentalMatrixIntoAPose) {
    TwoViews views = make_two_views({}, 18);
    const Camera truth = views.camera1;
    views.camera1.params[0] = views.camera2.params[0] = 1900;
    views.camera1.focal_source = views.camera2.focal_source = FocalSource::kUnknown;
    const Result<TwoViewGeometry> guessed = verify_pair(views.matched(), {}, kSeed);
    ASSERT_TRUE(guessed.ok()) << guessed.error().message;
    ASSERT_EQ(guessed->kind, TwoViewKind::kFundamental);
    ASSERT_GT(test::rotation_error_deg(guessed->cam2_from_cam1, views.cam2_from_cam1), 0.5);

    views.camera1 = views.camera2 = truth;
    const Result<TwoViewGeometry> seen = with_intrinsics(*guessed, views.matched(), {});
    ASSERT_TRUE(seen.ok()) << seen.error().message;
    EXPECT_EQ(seen->kind, TwoViewKind::kEssential);
    EXPECT_LT(test::rotation_error_deg(seen->cam2_from_cam1, views.cam2_from_cam1), 0.15);
    EXPECT_LT(test::direction_error_deg(seen->cam2_from_cam1, views.cam2_from_cam1), 0.5);
    EXPECT_TRUE(std::ranges::includes(guessed->inliers, seen->inliers));
    EXPECT_GE(seen->inliers.size() * 100, guessed->inliers.size() * 95);
}

TEST(WithIntrinsics, RotationStaysARotation) {
    TwoViewOptions options;
    options.turn_only = true;
    options.camera1.focal_source = options.camera2.focal_source = FocalSource::kUnknown;
    TwoViews views = make_two_views(options, 19);
    const Result<TwoViewGeometry> guessed = verify_pair(views.matched(), {}, kSeed);
    ASSERT_TRUE(guessed.ok()) << guessed.error().message;
    views.camera1.focal_source = views.camera2.focal_source = FocalSource::kEstimated;
    const Result<TwoViewGeometry> seen = with_intrinsics(*guessed, views.matched(), {});
    ASSERT_TRUE(seen.ok()) << seen.error().message;
    EXPECT_EQ(seen->kind, TwoViewKind::kPureRotation);
    EXPECT_LT(test::rotation_error_deg(seen->cam2_from_cam1, views.cam2_from_cam1), 0.1);
}

TEST(WithIntrinsics, ImpossibleFocalLengthIsAnError) {
    TwoViews views = make_two_views({}, 20);
    const Result<TwoViewGeometry> geometry = verify_pair(views.matched(), {}, kSeed);
    ASSERT_TRUE(geometry.ok());
    TwoViewGeometry few = *geometry;
    few.inliers.resize(10);
    EXPECT_EQ(with_intrinsics(few, views.matched(), {}).error().code, ErrorCode::kTooFewMatches);
}

}  // namespace
}  // namespace psfm
