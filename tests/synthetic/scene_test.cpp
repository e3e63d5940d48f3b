// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/synthetic/scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <set>

#include "tests/synthetic/compare.h"
#include "tests/synthetic/point_grid.h"
#include "tests/synthetic/rng.h"

namespace psfm::synthetic {
namespace {

struct NamedOptions {
    std::string name;
    SceneOptions options;
};
void PrintTo(const NamedOptions& named, std::ostream* stream) {
    *stream << named.name;
}

NamedOptions with_model(CameraModel model) {
    NamedOptions named{std::string(model_name(model)), ring_around_sphere(8)};
    named.options.cameras.model = model;
    named.options.cameras.shared = false;
    return named;
}

std::vector<NamedOptions> all_scenes() {
    NamedOptions random{"Random", ring_around_sphere(10)};
    random.options.cameras.path = Path::kRandom;
    random.options.cameras.distance = 12.0;
    return {{"Ring", ring_around_sphere(12)},
            {"Line", line_along_wall(12)},
            {"Grid", grid_over_ground(16)},
            {"Room", ring_in_room(16)},
            random,
            with_model(CameraModel::kSimplePinhole),
            with_model(CameraModel::kPinhole),
            with_model(CameraModel::kRadial),
            with_model(CameraModel::kOpenCv)};
}

class Scenes : public testing::TestWithParam<NamedOptions> {};

TEST_P(Scenes, FeaturesAreProjectionsOfTheirPoints) {
    ASSERT_TRUE(validate(GetParam().options).ok());
    const SyntheticScene scene = make_scene(GetParam().options, 1);
    ASSERT_EQ(scene.images.size(), GetParam().options.cameras.count);
    for (std::uint32_t i = 0; i < scene.images.size(); ++i) {
        const SceneImage& image = scene.images[i];
        ASSERT_EQ(image.keypoints.size(), image.feature_point.size());
        EXPECT_GT(image.keypoints.size(), 50U) << "image " << i << " sees too little";
        std::set<std::uint32_t> seen;
        for (std::size_t k = 0; k < image.keypoints.size(); ++k) {
            const SurfacePoint& point = scene.points.at(image.feature_point[k]);
            EXPECT_TRUE(seen.insert(image.feature_point[k]).second);
            const auto pixel =
                project(scene.camera_of(ImageId{i}), image.cam_from_world * point.position);
            ASSERT_TRUE(pixel.has_value());
            EXPECT_LT((*pixel - image.keypoints[k].position()).norm(), 1e-4);
            const Eigen::Vector3d to_camera =
                image.cam_from_world.target_origin_in_source() - point.position;
            EXPECT_GT(to_camera.dot(point.normal), 0.0) << "seen from behind";
        }
        EXPECT_TRUE(
            std::ranges::is_sorted(image.keypoints, std::ranges::greater{}, &Keypoint::scale));
    }
}

TEST_P(Scenes, EveryImageSharesPointsWithAnother) {
    const SyntheticScene scene = make_scene(GetParam().options, 1);
    std::vector<std::size_t> shared(scene.images.size(), 0);
    for (const std::vector<Observation>& track : tracks(scene)) {
        if (track.size() < 2) continue;
        for (const Observation& seen : track) ++shared[index_of(seen.image)];
    }
    for (const std::size_t count : shared) EXPECT_GT(count, 40U);
}

TEST_P(Scenes, AreTheSameForTheSameSeedOnly) {
    const SyntheticScene one = make_scene(GetParam().options, 5);
    const SyntheticScene same = make_scene(GetParam().options, 5);
    const SyntheticScene other = make_scene(GetParam().options, 6);
    for (std::size_t i = 0; i < one.images.size(); ++i) {
        EXPECT_EQ(one.images[i].keypoints, same.images[i].keypoints);
        EXPECT_NE(one.images[i].keypoints, other.images[i].keypoints);
    }
}

INSTANTIATE_TEST_SUITE_P(All, Scenes, testing::ValuesIn(all_scenes()),
                         [](const auto& test) { return test.param.name; });

TEST(LookAt, LooksThereWithTheHorizonLevel) {
    const Rigid3 pose = look_at({3, -4, 2}, {0, 0, 1});
    EXPECT_LT((pose.target_origin_in_source() - Eigen::Vector3d(3, -4, 2)).norm(), 1e-12);
    const Eigen::Vector3d target = pose * Eigen::Vector3d(0, 0, 1);
    EXPECT_NEAR(target.x(), 0.0, 1e-12);
    EXPECT_NEAR(target.y(), 0.0, 1e-12);
    EXPECT_GT(target.z(), 0.0);
    const Eigen::Vector3d up = pose.rotation * Eigen::Vector3d::UnitZ();
    EXPECT_NEAR(up.x(), 0.0, 1e-12) << "level";
    EXPECT_LT(up.y(), 0.0) << "y is down";
}

TEST(LookAt, CanLookStraightDown) {
    const Rigid3 pose = look_at({1, 2, 5}, {1, 2, 0});
    EXPECT_TRUE(pose.rotation.coeffs().allFinite());
    EXPECT_NEAR((pose * Eigen::Vector3d(1, 2, 0)).z(), 5.0, 1e-12);
}

TEST(MakePoints, LieOnTheirSurface) {
    for (const SurfacePoint& point :
         make_points({.surface = Surface::kSphere, .count = 500, .extent = {6, 6, 6}}, 1)) {
        EXPECT_NEAR(point.position.norm(), 3.0, 1e-12);
        EXPECT_GT(point.normal.dot(point.position), 0.0);
    }
    for (const SurfacePoint& point :
         make_points({.surface = Surface::kBoxRoom, .count = 500, .extent = {6, 4, 2}}, 1)) {
        const Eigen::Vector3d part = point.position.cwiseQuotient(Eigen::Vector3d(3, 2, 1));
        EXPECT_NEAR(part.cwiseAbs().maxCoeff(), 1.0, 1e-12);
        EXPECT_LT(point.normal.dot(point.position), 0.0) << "seen from inside";
    }
    const PointOptions wall{
        .surface = Surface::kReliefWall, .count = 500, .extent = {9, 1, 3}, .relief = 0.0};
    for (const SurfacePoint& point : make_points(wall, 1)) {
        EXPECT_EQ(point.position.y(), 0.0);
        EXPECT_EQ(point.normal, Eigen::Vector3d(0, -1, 0));
    }
}

TEST(MakePoints, HillsAreAsHighAsAskedAndHaveTheirNormals) {
    const PointOptions ground{
        .surface = Surface::kGround, .count = 1500, .extent = {30, 30, 1}, .relief = 0.7};
    const std::vector<SurfacePoint> points = make_points(ground, 2);
    double squares = 0.0;
    for (const SurfacePoint& point : points) squares += point.position.z() * point.position.z();
    EXPECT_NEAR(std::sqrt(squares / 1500.0), 0.7, 0.2);
    // A point's close neighbours lie in its tangent plane.
    std::size_t compared = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        for (std::size_t j = i + 1; j < points.size(); ++j) {
            const Eigen::Vector3d step = points[j].position - points[i].position;
            if (step.norm() > 0.25) continue;
            EXPECT_LT(std::abs(step.normalized().dot(points[i].normal)), 0.15);
            ++compared;
        }
    }
    EXPECT_GT(compared, 100U);
}

TEST(Visibility, LimitsAreKept) {
    SceneOptions options = ring_around_sphere(6);
    options.visibility = {.max_distance = 7.0, .max_normal_angle_deg = 40.0};
    const SyntheticScene scene = make_scene(options, 1);
    for (const SceneImage& image : scene.images) {
        const Eigen::Vector3d centre = image.cam_from_world.target_origin_in_source();
        EXPECT_GT(image.feature_point.size(), 20U);
        for (const std::uint32_t index : image.feature_point) {
            const Eigen::Vector3d to_camera = centre - scene.points[index].position;
            EXPECT_LE(to_camera.norm(), 7.0);
            EXPECT_GE(to_camera.normalized().dot(scene.points[index].normal),
                      std::cos(40.0 * std::numbers::pi / 180.0) - 1e-12);
        }
    }
}

TEST(Visibility, DetectionRateThinsOut) {
    SceneOptions options = ring_around_sphere(6);
    const SyntheticScene all = make_scene(options, 1);
    options.visibility.detection_rate = 0.5;
    const SyntheticScene half = make_scene(options, 1);
    for (std::size_t i = 0; i < all.images.size(); ++i) {
        const auto full = static_cast<double>(all.images[i].keypoints.size());
        EXPECT_NEAR(static_cast<double>(half.images[i].keypoints.size()) / full, 0.5, 0.1);
    }
}

TEST(Visibility, FewFeaturesAreTheSameOnesInEveryImage) {
    SceneOptions options = ring_around_sphere(24);
    options.visibility.max_features = 100;
    const SyntheticScene scene = make_scene(options, 1);
    std::size_t common = 0;
    for (const std::uint32_t point : scene.images[0].feature_point) {
        common += std::ranges::count(scene.images[1].feature_point, point);
    }
    EXPECT_EQ(scene.images[0].keypoints.size(), 100U);
    EXPECT_GT(common, 60U);
}

TEST(PointGrid, FindsWhatASearchOfAllFinds) {
    const std::vector<SurfacePoint> points =
        make_points({.surface = Surface::kBoxRoom, .count = 3000, .extent = {10, 10, 10}}, 1);
    const PointGrid grid(points, 0.7);
    Rng rng(1);
    for (int trial = 0; trial < 50; ++trial) {
        const Eigen::Vector3d centre = 5.0 * rng.normal3();
        const double radius = rng.uniform(0.1, 6.0);
        const std::vector<std::uint32_t> found = grid.near(centre, radius);
        EXPECT_TRUE(std::ranges::is_sorted(found));
        EXPECT_EQ(std::ranges::adjacent_find(found), found.end());
        for (std::uint32_t i = 0; i < points.size(); ++i) {
            if ((points[i].position - centre).norm() > radius) continue;
            EXPECT_TRUE(std::ranges::binary_search(found, i));
        }
    }
    EXPECT_EQ(
        PointGrid(points, std::numeric_limits<double>::infinity()).near({0, 0, 0}, 1.0).size(),
        3000U);
}

TEST(MakeScene, GrowsToThousandsOfImages) {
    SceneOptions options = line_along_wall(2000);
    options.visibility.max_distance = 9.0;
    const SyntheticScene scene = make_scene(options, 1);
    for (const SceneImage& image : scene.images) ASSERT_GT(image.keypoints.size(), 50U);
}

TEST(ReorderImages, OnlyRenames) {
    const SyntheticScene scene = make_scene(ring_around_sphere(9), 1);
    const std::vector<std::size_t> order = random_order(9, 3);
    const SyntheticScene renamed = reorder_images(scene, order);
    for (std::size_t i = 0; i < 9; ++i) {
        EXPECT_EQ(renamed.images[i].keypoints, scene.images[order[i]].keypoints);
        EXPECT_EQ(make_descriptors(renamed, ImageId{static_cast<std::uint32_t>(i)}, 0.1),
                  make_descriptors(scene, ImageId{static_cast<std::uint32_t>(order[i])}, 0.1));
    }
}

TEST(MakeDescriptors, NearestNeighboursAreTheTrueMatches) {
    SceneOptions options = ring_around_sphere(24);
    options.visibility.max_features = 200;
    const SyntheticScene scene = make_scene(options, 1);
    const Descriptors one = make_descriptors(scene, ImageId{0}, 0.1);
    const Descriptors two = make_descriptors(scene, ImageId{1}, 0.1);
    ASSERT_EQ(one.rows(), 200U);
    const auto distance = [&](std::size_t i, std::size_t j) {
        int sum = 0;
        for (std::size_t k = 0; k < Descriptors::kSize; ++k) {
            const int difference = one.row(i)[k] - two.row(j)[k];
            sum += difference * difference;
        }
        return sum;
    };
    for (std::size_t i = 0; i < one.rows(); ++i) {
        const auto truth =
            std::ranges::find(scene.images[1].feature_point, scene.images[0].feature_point[i]);
        if (truth == scene.images[1].feature_point.end()) continue;
        const auto own = static_cast<std::size_t>(truth - scene.images[1].feature_point.begin());
        for (std::size_t j = 0; j < two.rows(); ++j) {
            if (j == own) continue;
            EXPECT_LT(distance(i, own), distance(i, j));
        }
        // RootSIFT: length 512, but for rounding and clamping.
        double norm = 0.0;
        for (std::size_t k = 0; k < Descriptors::kSize; ++k) norm += one.row(i)[k] * one.row(i)[k];
        EXPECT_NEAR(std::sqrt(norm), 512.0, 10.0);
    }
}

TEST(TrueReconstruction, KeepsItsInvariantsInAnyGauge) {
    const SyntheticScene scene = make_scene(ring_around_sphere(12), 1);
    const std::vector<ImageId> some{ImageId{1}, ImageId{2}, ImageId{3}, ImageId{7}};
    const Reconstruction model = true_reconstruction(scene, random_gauge(4), some);
    ASSERT_EQ(model.images.size(), 4U);
    EXPECT_GT(model.points.size(), 100U);
    for (const ScenePoint& point : model.points) {
        ASSERT_GE(point.track.size(), 2U);
        EXPECT_TRUE(std::ranges::is_sorted(point.track));
        for (const Observation& seen : point.track) {
            const RegisteredImage* image = model.find(seen.image);
            ASSERT_NE(image, nullptr);
            const auto pixel =
                project(model.cameras.at(image->camera), image->cam_from_cluster * point.position);
            ASSERT_TRUE(pixel.has_value());
            const Keypoint& keypoint = scene.images[index_of(seen.image)].keypoints[seen.feature];
            EXPECT_LT((*pixel - keypoint.position()).norm(), 1e-3);
        }
    }
}

TEST(ValidateScene, RefusesNonsense) {
    const auto refused = [](const auto& change) {
        SceneOptions options;
        change(options);
        return !validate(options).ok();
    };
    EXPECT_FALSE(refused([](SceneOptions&) {}));
    EXPECT_TRUE(refused([](SceneOptions& o) { o.points.count = 0; }));
    EXPECT_TRUE(refused([](SceneOptions& o) { o.cameras.count = 0; }));
    EXPECT_TRUE(refused([](SceneOptions& o) { o.cameras.focal_px = 0.0; }));
    EXPECT_TRUE(refused([](SceneOptions& o) { o.cameras.arc_deg = 0.0; }));
    EXPECT_TRUE(refused([](SceneOptions& o) { o.points.extent.y() = 0.0; }));
    EXPECT_TRUE(refused([](SceneOptions& o) { o.visibility.detection_rate = 1.5; }));
    EXPECT_TRUE(refused([](SceneOptions& o) { o.visibility.max_distance = 0.0; }));
}

}  // namespace
}  // namespace psfm::synthetic
