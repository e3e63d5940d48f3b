// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/synthetic/compare.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "tests/synthetic/change_points.h"
#include "tests/synthetic/rng.h"

namespace psfm::synthetic {
namespace {

double distance(const Sim3& a, const Sim3& b) {
    return std::abs(a.scale / b.scale - 1.0) + angle_between(a.rotation, b.rotation) +
           (a.translation - b.translation).norm();
}

TEST(AlignPoints, FindsAPlantedSimilarity) {
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
        Rng rng(seed);
        const Sim3 truth = random_gauge(seed);
        std::vector<Eigen::Vector3d> source;
        std::vector<Eigen::Vector3d> target;
        const std::size_t count = 3 + rng.below(20);
        for (std::size_t i = 0; i < count; ++i) {
            source.push_back(3.0 * rng.normal3());
            target.push_back(truth * source.back());
        }
        EXPECT_LT(distance(align_points(source, target, rng.rotation()), truth), 1e-9);
    }
}

TEST(AlignPoints, AgreesWithEigensUmeyamaUnderNoise) {
    Rng rng(1);
    Eigen::Matrix3Xd source(3, 30);
    Eigen::Matrix3Xd target(3, 30);
    std::vector<Eigen::Vector3d> source_list;
    std::vector<Eigen::Vector3d> target_list;
    const Sim3 truth = random_gauge(1);
    for (Eigen::Index i = 0; i < 30; ++i) {
        source.col(i) = 3.0 * rng.normal3();
        target.col(i) = truth * source.col(i) + rng.normal3();
        source_list.emplace_back(source.col(i));
        target_list.emplace_back(target.col(i));
    }
    const Eigen::Matrix4d expected = Eigen::umeyama(source, target);
    const Sim3 found = align_points(source_list, target_list, Eigen::Quaterniond::Identity());
    // Umeyama's scale minimises the target's residuals given that noise is in the target only, as
    // ours does.
    EXPECT_LT(
        (found.scale * found.rotation.toRotationMatrix() - expected.topLeftCorner<3, 3>()).norm(),
        1e-9);
    EXPECT_LT((found.translation - expected.topRightCorner<3, 1>()).norm(), 1e-9);
}

TEST(AlignPoints, TakesTheHintForPointsOnALine) {
    const Sim3 truth = random_gauge(3);
    std::vector<Eigen::Vector3d> source;
    std::vector<Eigen::Vector3d> target;
    for (int i = 0; i < 5; ++i) {
        source.emplace_back(i, 2.0 * i, -i);
        target.push_back(truth * source.back());
    }
    EXPECT_LT(distance(align_points(source, target, truth.rotation), truth), 1e-9);
}

TEST(AlignPoints, NeverReflects) {
    std::vector<Eigen::Vector3d> source;
    std::vector<Eigen::Vector3d> mirrored;
    Rng rng(4);
    for (int i = 0; i < 10; ++i) {
        source.push_back(rng.normal3());
        mirrored.emplace_back(-source.back().x(), source.back().y(), source.back().z());
    }
    const Sim3 found = align_points(source, mirrored, Eigen::Quaterniond::Identity());
    EXPECT_NEAR(found.rotation.toRotationMatrix().determinant(), 1.0, 1e-12);
    EXPECT_NEAR(found.rotation.norm(), 1.0, 1e-12);
}

TEST(MeanRotation, IsTheMiddleWhateverTheSigns) {
    const Eigen::Quaterniond middle = Rng(5).rotation();
    std::vector<Eigen::Quaterniond> around;
    for (const double angle : {-0.2, -0.1, 0.0, 0.1, 0.2}) {
        Eigen::Quaterniond turned(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitX()));
        turned = middle * turned;
        if (angle > 0.05) turned.coeffs() = -turned.coeffs().eval();
        around.push_back(turned);
    }
    EXPECT_LT(angle_between(mean_rotation(around), middle), 1e-12);
}

TEST(CompareWithTruth, FindsNoErrorInTheTruthInAnyGauge) {
    for (const SceneOptions& options :
         {ring_around_sphere(12), line_along_wall(8), grid_over_ground(9)}) {
        const SyntheticScene scene = make_scene(options, 1);
        const auto error = compare_with_truth(true_reconstruction(scene, random_gauge(2)), scene);
        ASSERT_TRUE(error.ok());
        EXPECT_EQ(error->images, scene.images.size());
        EXPECT_LT(error->max_position, 1e-9);
        EXPECT_LT(error->max_rotation_deg, 1e-6);
        EXPECT_LT(error->median_point, 1e-9);
        EXPECT_EQ(error->mixed_tracks, 0U);
        EXPECT_LT(distance(error->world_from_cluster, inverse(random_gauge(2))), 1e-8);
    }
}

TEST(CompareWithTruth, HandlesCamerasOnAnExactLine) {
    SceneOptions options = line_along_wall(6);
    options.cameras.shift_sigma = 0.0;
    const SyntheticScene scene = make_scene(options, 1);
    const auto error = compare_with_truth(true_reconstruction(scene, random_gauge(2)), scene);
    ASSERT_TRUE(error.ok());
    EXPECT_LT(error->max_position, 1e-9);
    EXPECT_LT(error->median_point, 1e-9);
}

TEST(CompareWithTruth, SeesOneImageThatIsOff) {
    const SyntheticScene scene = make_scene(ring_around_sphere(30), 1);
    const Sim3 gauge = random_gauge(2);
    Reconstruction model = true_reconstruction(scene, gauge);
    // 0.5 m to the side and 2 degrees turned, about its own new centre.
    Rigid3& pose = model.images[4].cam_from_cluster;
    const Eigen::Vector3d centre =
        pose.target_origin_in_source() + 0.5 * gauge.scale * Eigen::Vector3d::UnitX();
    pose.rotation =
        Eigen::AngleAxisd(2.0 * std::numbers::pi / 180.0, Eigen::Vector3d::UnitY()) * pose.rotation;
    pose.translation = -(pose.rotation * centre);
    const auto error = compare_with_truth(model, scene);
    ASSERT_TRUE(error.ok());
    EXPECT_NEAR(error->max_position, 0.5, 0.05);
    EXPECT_LT(error->mean_position, 0.05);
    EXPECT_NEAR(error->max_rotation_deg, 2.0, 0.2);
}

TEST(CompareWithTruth, SeesMovedPointsAndMixedTracks) {
    const SyntheticScene scene = make_scene(ring_around_sphere(8), 1);
    Reconstruction model = true_reconstruction(scene);
    change_points(model, [](std::vector<ScenePoint>& points) {
        for (ScenePoint& point : points) point.position += Eigen::Vector3d(0.0, 0.0, 0.25);
        std::swap(points[0].track[0].feature, points[1].track[0].feature);
        points[0].track[0].image = points[1].track[0].image = ImageId{0};
        points[0].track[0].feature = 0;
        points[1].track[0].feature = 1;
    });
    const auto error = compare_with_truth(model, scene);
    ASSERT_TRUE(error.ok());
    EXPECT_NEAR(error->median_point, 0.25, 1e-9);
    EXPECT_GE(error->mixed_tracks, 1U);
    EXPECT_LE(error->mixed_tracks, 2U);
}

TEST(CompareWithTruth, RefusesTooFewOrUnknownImages) {
    const SyntheticScene scene = make_scene(ring_around_sphere(4), 1);
    EXPECT_EQ(compare_with_truth({}, scene).error().code, ErrorCode::kTooFewMatches);
    Reconstruction model = true_reconstruction(scene);
    model.images.back().image = ImageId{99};
    EXPECT_EQ(compare_with_truth(model, scene).error().code, ErrorCode::kNotFound);
}

}  // namespace
}  // namespace psfm::synthetic
