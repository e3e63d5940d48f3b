// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <memory>

#include "stages/reconstruction/solve/solve_cluster.h"
#include "tests/stages/reconstruction/problems.h"
#include "tests/synthetic/compare.h"
#include "tests/synthetic/disturb.h"
#include "tests/synthetic/verified_pairs.h"

namespace psfm {
namespace {

using synthetic::SyntheticScene;

constexpr std::uint32_t kImages = 14;

/// A ring around a sphere, seen through a lens of two coefficients.
SyntheticScene ring_seen_through(double k1, double k2) {
    synthetic::SceneOptions options = synthetic::ring_around_sphere(kImages);
    options.points.extent = {7.0, 7.0, 7.0};  // to the edges of the photographs
    options.cameras.model = CameraModel::kRadial;
    options.cameras.k1 = k1;
    options.cameras.k2 = k2;
    return synthetic::add_pixel_noise(synthetic::make_scene(options, 5), 0.15, 6);
}

/// Its model, as far as one coefficient goes, that is to settle.
ClusterProblem settling(const SyntheticScene& scene, FocalSource source) {
    ClusterProblem problem = problem_of(scene, synthetic::make_verified_pairs(scene));
    Reconstruction model = synthetic::true_reconstruction(scene);
    for (auto* cameras : {&problem.cameras, &model.cameras}) {
        for (auto& [id, camera] : *cameras) {
            camera.model = CameraModel::kSimpleRadial;
            camera.params[4] = 0.0;
            camera.focal_source = source;
        }
    }
    problem.recycled = {std::make_shared<const Reconstruction>(model)};
    problem.settle = true;
    return problem;
}

struct Settled {
    Camera camera;
    double error = 1e9;  ///< mean, of the positions [m]
};

Settled settled(const SyntheticScene& scene, const LensOptions& lenses,
                FocalSource source = FocalSource::kEstimated) {
    SolveOptions options;
    options.lenses = lenses;
    const auto solution = solve_cluster(settling(scene, source), options);
    EXPECT_TRUE(solution.ok());
    if (!solution.ok()) return {};
    EXPECT_EQ(solution->model->images.size(), kImages);
    const auto error = synthetic::compare_with_truth(*solution->model, scene);
    EXPECT_TRUE(error.ok());
    return {solution->model->cameras.begin()->second, error.ok() ? error->mean_position : 1e9};
}

TEST(SettleLenses, ALensThatOneCoefficientDoesNotDescribeGetsASecond) {
    const SyntheticScene scene = ring_seen_through(0.04, -0.08);
    const Settled bent = settled(scene, {.min_images = 0});
    EXPECT_EQ(bent.camera.model, CameraModel::kSimpleRadial);
    const Settled right = settled(scene, {});
    EXPECT_EQ(right.camera.model, CameraModel::kRadial);
    EXPECT_NEAR(right.camera.params[3], 0.04, 0.005);
    EXPECT_NEAR(right.camera.params[4], -0.08, 0.015);
    EXPECT_LT(right.error, 0.7 * bent.error);
}

TEST(SettleLenses, OneThatItDescribesDoesNot) {
    const Settled one = settled(ring_seen_through(-0.05, 0.0), {});
    EXPECT_EQ(one.camera.model, CameraModel::kSimpleRadial);
    EXPECT_EQ(one.camera.params[4], 0.0);
}

TEST(SettleLenses, NorDoesOneOfFewImagesOrAGivenOne) {
    const SyntheticScene scene = ring_seen_through(0.04, -0.08);
    EXPECT_EQ(settled(scene, {.min_images = kImages + 1}).camera.model, CameraModel::kSimpleRadial);
    EXPECT_EQ(settled(scene, {.min_images = kImages}).camera.model, CameraModel::kRadial);
    EXPECT_EQ(settled(scene, {}, FocalSource::kGiven).camera.model, CameraModel::kSimpleRadial);
}

TEST(SettleLenses, AFocalLengthMayChangeWhereTheSceneDeterminesIt) {
    const SyntheticScene scene = ring_seen_through(0.15, -0.3);
    const Settled right = settled(scene, {});
    EXPECT_EQ(right.camera.model, CameraModel::kRadial);
    EXPECT_NEAR(right.camera.fx(), scene.cameras.begin()->second.fx(), 2.0);
    const Settled careful = settled(scene, {.min_focal_curvature = 1e3});
    EXPECT_EQ(careful.camera.model, CameraModel::kSimpleRadial);
    EXPECT_EQ(settled(scene, {.max_focal_change = 0.1, .min_focal_curvature = 1e3}).camera.model,
              CameraModel::kRadial);
}

TEST(SettleLenses, FlatLandWhoseFocalLengthNothingHoldsKeepsItsModel) {
    // Seen straight down through a lens that one coefficient does not describe: the nearer to wide
    // angle the better, to where no camera is.
    synthetic::SceneOptions flight;
    flight.points.surface = synthetic::Surface::kGround;
    flight.points.extent = {16.0, 16.0, 0.0};
    flight.points.relief = 0.2;
    flight.points.count = 4000;
    flight.cameras = {
        .path = synthetic::Path::kGrid, .count = kImages, .radius = 3.0, .height = 6.0};
    flight.cameras.turn_sigma_deg = 0.5;
    flight.cameras.model = CameraModel::kRadial;
    flight.cameras.k1 = 0.04;
    flight.cameras.k2 = -0.08;
    const SyntheticScene scene =
        synthetic::add_pixel_noise(synthetic::make_scene(flight, 5), 0.15, 6);
    EXPECT_TRUE(validate(settled(scene, {}).camera).ok());
}

}  // namespace
}  // namespace psfm
