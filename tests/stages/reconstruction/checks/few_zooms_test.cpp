// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/checks/few_zooms.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "stages/reconstruction/solve/solve_cluster.h"
#include "tests/stages/reconstruction/alike_cameras.h"

namespace psfm {
namespace {

/// Cameras of 100 observations with these focal lengths by themselves; all have 1000 px together.
std::vector<ReleasedCamera> with_focals(const std::vector<double>& focals) {
    std::vector<ReleasedCamera> cameras;
    for (const double focal : focals) {
        ReleasedCamera& camera = cameras.emplace_back();
        camera.camera = static_cast<CameraId>(cameras.size() - 1);
        camera.tied_focal_px = 1000.0;
        camera.own_focal_px = focal;
        camera.own_cost = 0.1;
        const double step = std::log(focal / 1000.0);
        camera.tied_cost = 0.1 + step * step;  // all are equally sure
        camera.observations = 100;
    }
    return cameras;
}

using Labels = std::vector<std::size_t>;

TEST(PartByZoom, PartsWhereFocalLengthsVaryLeastWithin) {
    const auto cameras = with_focals({1210.0, 930.0, 910.0, 1190.0, 960.0, 1350.0});
    EXPECT_EQ(part_by_zoom(cameras, 1), (Labels{0, 0, 0, 0, 0, 0}));
    EXPECT_EQ(part_by_zoom(cameras, 2), (Labels{1, 0, 0, 1, 0, 1}));
    EXPECT_EQ(part_by_zoom(cameras, 3), (Labels{1, 0, 0, 1, 0, 2}));
    EXPECT_TRUE(part_by_zoom(cameras, 7).empty());
}

TEST(PartByZoom, WhoGainsNothingDoesNotCount) {
    auto cameras = with_focals({900.0, 905.0, 1200.0, 1205.0, 3000.0});
    EXPECT_EQ(part_by_zoom(cameras, 2), (Labels{0, 0, 0, 0, 1})) << "it is sure, here";
    cameras[4].tied_cost = cameras[4].own_cost + 1e-4;
    EXPECT_EQ(part_by_zoom(cameras, 2), (Labels{0, 0, 1, 1, 1}));
}

/// Twelve photographs round a sphere, every third zoomed, of which some see little.
ClusterProblem thin_with_zooms(double factor) {
    synthetic::SyntheticScene scene =
        with_own_cameras(synthetic::make_scene(synthetic::ring_around_sphere(12), 9));
    for (std::size_t i = 1; i < 12; i += 3) zoom(scene, i, factor);
    return problem_without_exif(synthetic::add_pixel_noise(std::move(scene), 1.0, 9));
}

std::size_t cameras_of(const ClusterProblem& problem, std::uint32_t max_zooms) {
    SolveOptions options;
    options.ties.max_zooms = max_zooms;
    const auto solution = solve_cluster(problem, options);
    EXPECT_TRUE(solution.ok());
    return solution.ok() ? solution->model->cameras.size() : 0;
}

// A pixel of noise: by itself each tells its focal length to some per cent, so that they leave no
// gap, or several.
TEST(FindZooms, TwoZoomsAreTwoCamerasThoughEachIsUnsure) {
    const ClusterProblem problem = thin_with_zooms(1.3);
    EXPECT_EQ(cameras_of(problem, 4), 2U);
    EXPECT_GT(cameras_of(problem, 1), 2U) << "without the question";
}

// Models that were adjusted with other ties may place other images.
TEST(FindZooms, OnlyOfTheCamerasThatItIsAskedAbout) {
    const ClusterProblem problem = thin_with_zooms(1.3);
    SolveOptions options;
    options.ties.max_zooms = 1;
    const auto solution = solve_cluster(problem, options);
    ASSERT_TRUE(solution.ok());
    const auto adjusted = [&](const CameraTies& ties) {
        return adjust_tied(solution->model, problem, ties, 1, options.ties);
    };
    const TiedModel apart = adjusted(untied(problem));
    const Kinds kinds = compare_ties(adjusted(all_tied(problem)), apart, problem, options.ties);
    ASSERT_EQ(kinds.size(), 1U);
    std::vector<ReleasedCamera> asked = kinds.begin()->second;
    ASSERT_EQ(asked.size(), 12U);
    // Four wide ones and two zoomed ones are left with each other, and some of them deviate.
    asked.erase(asked.begin(), asked.begin() + 6);
    const auto zooms =
        find_zooms(asked, apart, problem, labels_of(all_tied(problem)), TieOptions());
    EXPECT_FALSE(zooms.empty());
    for (const auto& [camera, zoom] : zooms) EXPECT_GE(camera, CameraId{6});
}

// An image that was placed with a wrong zoom, where it fits best with that, is told its own.
TEST(CostsByLens, AnImagePlacedWithAWrongZoomCostsLessWithItsOwn) {
    const ClusterProblem problem = thin_with_zooms(1.3);
    const auto solution = solve_cluster(problem, {});
    ASSERT_TRUE(solution.ok());
    ASSERT_EQ(solution->model->cameras.size(), 2U);
    Reconstruction bent = *solution->model;
    const Camera wide = bent.cameras.at(bent.find(ImageId{0})->camera);
    const Camera zoomed = bent.cameras.at(bent.find(ImageId{1})->camera);
    for (RegisteredImage& image : bent.images) {
        if (image.image != ImageId{1}) continue;
        image.camera = bent.find(ImageId{0})->camera;
        image.cam_from_cluster.translation.z() /= 1.3;  // as near as it looks
    }
    const auto costs =
        costs_by_lens(std::make_shared<const Reconstruction>(bent), problem,
                      std::vector{CameraId{0}, CameraId{1}}, std::vector{wide, zoomed}, {});
    ASSERT_EQ(costs.size(), 2U);
    const double sure = TieOptions().min_zoom_gain;
    EXPECT_LT(sure * costs.at(CameraId{0})[0], costs.at(CameraId{0})[1]);
    EXPECT_LT(sure * costs.at(CameraId{1})[1], costs.at(CameraId{1})[0]);
}

}  // namespace
}  // namespace psfm
