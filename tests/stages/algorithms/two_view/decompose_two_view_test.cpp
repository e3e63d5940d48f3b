// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/two_view/decompose_two_view.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "stages/algorithms/two_view/invert_two_view_geometry.h"
#include "stages/algorithms/two_view/refine_two_view.h"
#include "tests/stages/verification/two_views.h"

namespace psfm {
namespace {

test::TwoViews clean(test::Shape shape) {
    test::TwoViewOptions options;
    options.shape = shape;
    options.wrong = 0;
    options.noise_px = 0;
    return make_two_views(options, 2);
}

std::vector<PointPair> points_of(const test::TwoViews& views) {
    return make_two_view_problem(views.matched(), 1.0)->normalized;
}

TEST(DecomposeTwoView, OneOfFourPosesOfAnEssentialMatrixHasAllPointsInFront) {
    const test::TwoViews views = clean(test::Shape::kVolume);
    const std::vector<PointPair> points = points_of(views);
    const std::vector<Rigid3> candidates =
        poses_from_essential(-3.0 * fundamental_from_pose(views.cam2_from_cam1, {}));
    ASSERT_EQ(candidates.size(), 4U);
    const PoseChoice choice = choose_by_cheirality(candidates, points);
    EXPECT_EQ(choice.in_front, points.size());
    EXPECT_LT(test::rotation_error_deg(choice.cam2_from_cam1, views.cam2_from_cam1), 1e-6);
    EXPECT_LT(test::direction_error_deg(choice.cam2_from_cam1, views.cam2_from_cam1), 1e-6);
    for (const Rigid3& candidate : candidates) {
        if (test::rotation_error_deg(candidate, views.cam2_from_cam1) < 1 &&
            test::direction_error_deg(candidate, views.cam2_from_cam1) < 1) {
            continue;
        }
        EXPECT_LT(choose_by_cheirality(std::span(&candidate, 1), points).in_front,
                  points.size() / 10);
    }
}

TEST(DecomposeTwoView, PlanesHomographyAllowsTheTruth) {
    const test::TwoViews views = clean(test::Shape::kPlane);
    // z = 7 + 0.5 x - 0.3 y is n' X = d with n = (-0.5, 0.3, 1), d = 7; X2 = (R + t n' / d) X1.
    const Eigen::Vector3d baseline(-1.5, 0.2, 0.3);
    const Eigen::Matrix3d h = views.cam2_from_cam1.rotation.toRotationMatrix() +
                              baseline * Eigen::RowVector3d(-0.5, 0.3, 1) / 7.0;
    double best = 180;
    for (const Rigid3& pose : poses_from_homography(h)) {
        best = std::min(best, test::rotation_error_deg(pose, views.cam2_from_cam1) +
                                  test::direction_error_deg(pose, views.cam2_from_cam1));
    }
    EXPECT_LT(best, 1e-4);
}

TEST(DecomposeTwoView, RaysMeetInFrontOrBehind) {
    const Rigid3 sideways{Eigen::Quaterniond::Identity(), {-1, 0, 0}};
    // A point at (0, 0, 2) is seen at x = 0 and at x = -0.5.
    const RayMeeting meeting(sideways);
    EXPECT_TRUE(meeting.is_in_front({{0, 0}, {-0.5, 0}}));
    EXPECT_NEAR(meeting.angle({{0, 0}, {-0.5, 0}}), std::atan(0.5), 1e-12);
    EXPECT_FALSE(meeting.is_in_front({{0, 0}, {0.5, 0}}));
    EXPECT_FALSE(meeting.passes_cheirality({{0, 0}, {0.5, 0}}, 0.01));
    EXPECT_TRUE(meeting.passes_cheirality({{0, 0}, {0.001, 0}}, 0.01))
        << "parallel within the slack";
    // One on its way to the point, the other away from it: in front of one camera only.
    const RayMeeting forward({Eigen::Quaterniond::Identity(), {0, 0, -3}});
    EXPECT_FALSE(forward.is_in_front({{0.5, 0}, {-1, 0}})) << "(1, 0, 2) lies behind the second";
    EXPECT_FALSE(
        RayMeeting({Eigen::Quaterniond::Identity(), {0, 0, 3}}).is_in_front({{-1, 0}, {0.5, 0}}))
        << "(1, 0, -1) lies behind the first";
}

TEST(DecomposeTwoView, MedianAngleOfNothingIsZero) {
    EXPECT_EQ(median_triangulation_angle_deg({}, {}), 0.0);
    EXPECT_NEAR(median_triangulation_angle_deg({Eigen::Quaterniond::Identity(), {-1, 0, 0}},
                                               std::vector<PointPair>{{{0, 0}, {-1, 0}}}),
                45.0, 1e-9);
}

TEST(InvertTwoViewGeometry, TwiceIsTheIdentityAndOnceFitsTheSwappedPoints) {
    const test::TwoViews views = clean(test::Shape::kVolume);
    TwoViewGeometry geometry;
    geometry.cam2_from_cam1 = views.cam2_from_cam1;
    geometry.matrix = fundamental_from_pose(views.cam2_from_cam1, {}).normalized();
    geometry.inliers = {{1, 9}, {2, 3}, {5, 4}};
    const TwoViewGeometry inverted = invert(geometry);
    EXPECT_EQ(inverted.inliers, (std::vector<FeatureMatch>{{3, 2}, {4, 5}, {9, 1}}));
    EXPECT_NEAR(inverted.cam2_from_cam1.translation.norm(), 1.0, 1e-12);
    for (const PointPair& p : points_of(views)) {
        EXPECT_LT(std::abs(sampson_residual(inverted.matrix, {p.x2, p.x1})), 1e-6);
        EXPECT_TRUE(RayMeeting(inverted.cam2_from_cam1).is_in_front({p.x2, p.x1}));
    }
    const TwoViewGeometry again = invert(inverted);
    EXPECT_EQ(again.inliers, geometry.inliers);
    EXPECT_LT((again.matrix - geometry.matrix).norm(), 1e-12);
    EXPECT_LT((again.cam2_from_cam1.translation - geometry.cam2_from_cam1.translation).norm(),
              1e-12);

    geometry.kind = TwoViewKind::kPlanar;
    geometry.matrix << 1, 0.1, 3, 0, 1.2, -2, 0.001, 0, 1;
    const Eigen::Matrix3d product = invert(geometry).matrix * geometry.matrix;
    EXPECT_LT((product / product(0, 0) - Eigen::Matrix3d::Identity()).norm(), 1e-9);
}

}  // namespace
}  // namespace psfm
