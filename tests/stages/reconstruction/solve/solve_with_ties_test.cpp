// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Whether photographs without EXIF are found to be of one camera where they are, and only there.
#include "stages/reconstruction/solve/solve_with_ties.h"

#include <gtest/gtest.h>

#include "stages/reconstruction/solve/solve_cluster.h"
#include "tests/stages/reconstruction/alike_cameras.h"
#include "tests/synthetic/compare.h"

namespace psfm {
namespace {

using synthetic::SyntheticScene;

SyntheticScene ring(std::uint32_t images, std::uint64_t seed) {
    return with_own_cameras(synthetic::make_scene(synthetic::ring_around_sphere(images), seed));
}

SyntheticScene with_noise(SyntheticScene scene, std::uint64_t seed) {
    return synthetic::add_pixel_noise(std::move(scene), 0.3, seed);
}

ClusterSolution solved(const ClusterProblem& problem) {
    const auto solution = solve_cluster(problem, {});
    EXPECT_TRUE(solution.ok());
    return solution.ok() ? *solution : ClusterSolution{};
}

/// Relative to the ring's radius of 8 m, or half the width of what is flown over.
double error_of(const ClusterSolution& solution, const SyntheticScene& scene) {
    const auto error = synthetic::compare_with_truth(*solution.model, scene);
    EXPECT_TRUE(error.ok());
    return error.ok() ? error->max_position / 8.0 : 1.0;
}

double focal_of(const ClusterSolution& solution, std::uint32_t image) {
    const RegisteredImage* placed = solution.model->find(static_cast<ImageId>(image));
    return placed == nullptr ? 0.0 : solution.model->cameras.at(placed->camera).fx();
}

TEST(SolveWithTies, PhotographsOfOneCameraShareIt) {
    const SyntheticScene scene = with_noise(ring(12, 1), 1);
    const ClusterSolution solution = solved(problem_without_exif(scene));
    ASSERT_EQ(solution.model->images.size(), 12U);
    EXPECT_EQ(solution.model->cameras.size(), 1U);
    EXPECT_FALSE(solution.statistics.ties_changed);
    EXPECT_NEAR(focal_of(solution, 0), 900.0, 9.0);
    EXPECT_LT(error_of(solution, scene), 0.003);
}

// A plane from above tells focal lengths of single photographs from heights badly: each by itself
// is off by a fifth.
TEST(SolveWithTies, AFlightOverFlatLandIsOfOneCamera) {
    synthetic::SceneOptions options = synthetic::grid_over_ground(15);
    options.points.relief = 0.05;
    options.cameras.turn_sigma_deg = 4.0;
    const SyntheticScene scene = with_noise(with_own_cameras(synthetic::make_scene(options, 2)), 2);
    const ClusterSolution solution = solved(problem_without_exif(scene));
    ASSERT_EQ(solution.model->images.size(), 15U);
    EXPECT_EQ(solution.model->cameras.size(), 1U);
}

// One coefficient of a photograph's own suits the part of the lens that its points are seen through
// better than one of all photographs does: that is no camera of its own.
TEST(SolveWithTies, ALensThatOneCoefficientDoesNotDescribeIsOfOneCamera) {
    synthetic::SceneOptions scene_options = synthetic::grid_over_ground(15);
    scene_options.cameras.model = CameraModel::kRadial;
    scene_options.cameras.k1 = -0.25;
    scene_options.cameras.k2 = 0.125;
    const SyntheticScene scene =
        with_noise(with_own_cameras(synthetic::make_scene(scene_options, 3)), 3);
    for (const bool second_coefficient : {false, true}) {
        SCOPED_TRACE(second_coefficient);
        SolveOptions options;
        options.ties.second_coefficient = second_coefficient;
        if (!second_coefficient) options.ties.max_zooms = 1;  // which would find two
        const auto solution = solve_cluster(problem_without_exif(scene), options);
        ASSERT_TRUE(solution.ok());
        ASSERT_EQ(solution->model->images.size(), 15U);
        EXPECT_EQ(solution->model->cameras.size(), second_coefficient ? 1U : 15U);
    }
}

TEST(SolveWithTies, EverySecondPhotographZoomedIsAnotherCamera) {
    for (const double factor : {1.54, 1.8}) {
        SCOPED_TRACE(factor);
        SyntheticScene scene = ring(12, 3);
        for (std::size_t i = 1; i < 12; i += 2) zoom(scene, i, factor);
        scene = with_noise(std::move(scene), 3);
        const ClusterSolution solution = solved(problem_without_exif(scene));
        ASSERT_EQ(solution.model->images.size(), 12U);
        EXPECT_EQ(solution.model->cameras.size(), 2U);
        for (std::uint32_t i = 0; i < 12; ++i)
            EXPECT_NEAR(focal_of(solution, i), i % 2 == 0 ? 900.0 : 900.0 * factor, 15.0) << i;
        EXPECT_LT(error_of(solution, scene), 0.005);
    }
}

// Too near to each other to be told for sure: they are parted, at the price of some accuracy.
TEST(SolveWithTies, NearZoomsAreNotTakenForOne) {
    for (const double factor : {1.1, 1.3}) {
        SCOPED_TRACE(factor);
        SyntheticScene scene = ring(12, 3);
        for (std::size_t i = 1; i < 12; i += 2) zoom(scene, i, factor);
        scene = with_noise(std::move(scene), 3);
        const ClusterSolution solution = solved(problem_without_exif(scene));
        ASSERT_EQ(solution.model->images.size(), 12U);
        EXPECT_GE(solution.model->cameras.size(), 2U);
        EXPECT_LT(error_of(solution, scene), 0.05);
    }
}

TEST(SolveWithTies, OneZoomedPhotographLeavesTheOthersTogether) {
    SyntheticScene scene = ring(12, 4);
    zoom(scene, 0, 1.25);  // the one that the others would be named after
    scene = with_noise(std::move(scene), 4);
    const ClusterSolution solution = solved(problem_without_exif(scene));
    ASSERT_EQ(solution.model->images.size(), 12U);
    ASSERT_EQ(solution.model->cameras.size(), 2U);
    EXPECT_TRUE(solution.statistics.ties_changed);
    EXPECT_NEAR(focal_of(solution, 0), 1125.0, 15.0);
    EXPECT_NEAR(focal_of(solution, 1), 900.0, 9.0);
}

TEST(SolveWithTies, PortraitAndLandscapeShareTheirLens) {
    SyntheticScene scene = ring(12, 5);
    for (const std::size_t i : {2, 5, 6, 9}) turn(scene, i);
    scene = with_noise(std::move(scene), 5);
    const ClusterSolution solution = solved(problem_without_exif(scene));
    ASSERT_EQ(solution.model->images.size(), 12U);
    ASSERT_EQ(solution.model->cameras.size(), 2U);
    const Camera& landscape = solution.model->cameras.begin()->second;
    const Camera& portrait = solution.model->cameras.rbegin()->second;
    EXPECT_EQ(landscape.width, 1000U);
    EXPECT_EQ(portrait.width, 750U);
    EXPECT_EQ(landscape.fx(), portrait.fx());
    EXPECT_EQ(landscape.params[3], portrait.params[3]);
    EXPECT_NEAR(landscape.fx(), 900.0, 9.0);
    EXPECT_LT(error_of(solution, scene), 0.006);
}

TEST(SolveWithTies, OneOfAnotherSizeHasACameraOfItsOwn) {
    SyntheticScene scene = ring(12, 6);
    Camera& cropped = scene.cameras.at(static_cast<CameraId>(7));
    cropped.height = 650;  // of 750: as much is missing above as below
    cropped.params[2] -= 50;
    for (Keypoint& keypoint : scene.images[7].keypoints) keypoint.y -= 50;
    keep_inside(cropped, scene.images[7]);
    scene = with_noise(std::move(scene), 6);
    const ClusterSolution solution = solved(problem_without_exif(scene));
    ASSERT_EQ(solution.model->images.size(), 12U);
    EXPECT_EQ(solution.model->cameras.size(), 2U);
    EXPECT_NEAR(focal_of(solution, 0), 900.0, 9.0);
    EXPECT_NEAR(focal_of(solution, 7), 900.0, 65.0);
}

/// What was decided with few images is decided anew when the model settles, in any order.
TEST(SolveWithTies, NewImagesJoinAndTheVerdictIsRevised) {
    SyntheticScene scene = ring(14, 7);
    for (const std::size_t i : {10, 11, 12, 13}) zoom(scene, i, 1.3);
    scene = with_noise(std::move(scene), 7);
    const ClusterProblem ten = problem_without_exif(scene, 10);
    const ClusterSolution first = solved(ten);
    ASSERT_EQ(first.model->cameras.size(), 1U);

    ClusterProblem all = problem_without_exif(scene);
    all.recycled = {first.model};
    all.recycled_state = first.state;
    all.settle = true;
    const ClusterSolution second = solved(all);
    ASSERT_EQ(second.model->images.size(), 14U);
    EXPECT_EQ(second.model->cameras.size(), 2U);
    EXPECT_NEAR(focal_of(second, 13), 1170.0, 18.0);
    EXPECT_NEAR(focal_of(second, 0), 900.0, 9.0);

    // A session of an earlier program: each image by itself, where all are of one camera.
    ClusterProblem apart = ten;
    apart.alike.clear();
    ClusterProblem settled = ten;
    settled.recycled = {solved(apart).model};
    EXPECT_EQ(settled.recycled.front()->cameras.size(), 10U);
    settled.settle = true;
    EXPECT_EQ(solved(settled).model->cameras.size(), 1U);
}

TEST(SolveWithTies, ModelsFromWhereCamerasWereTiedHaveThoseOfTheProblem) {
    const SyntheticScene scene = ring(8, 1);
    ClusterProblem problem = problem_without_exif(scene);
    problem.alike.clear();
    std::vector<ImageId> ids;
    for (const ClusterImage& image : problem.images) ids.push_back(image.id);
    Reconstruction tied = synthetic::true_reconstruction(scene, Sim3{}, ids);
    const Camera lens = tied.cameras.begin()->second;
    tied.cameras = {{CameraId{77}, lens}};
    for (RegisteredImage& image : tied.images) image.camera = CameraId{77};
    problem.recycled = {std::make_shared<const Reconstruction>(std::move(tied))};
    const auto solution = solve_with_ties(problem, {}, [&](const ClusterProblem& asked) {
        const Reconstruction& model = *asked.recycled.front();
        for (std::size_t i = 0; i < model.images.size(); ++i) {
            EXPECT_EQ(model.images[i].camera, asked.images[i].camera);
            EXPECT_EQ(model.cameras.at(model.images[i].camera).fx(), lens.fx());
        }
        return Result<SolveAttempt>(SolveAttempt{});
    });
    EXPECT_TRUE(solution.ok());
}

TEST(SolveWithTies, GivenIntrinsicsAreNotTied) {
    const SyntheticScene scene = with_noise(ring(8, 8), 8);
    ClusterProblem problem = problem_without_exif(scene);
    problem.fix_intrinsics = true;
    problem.cameras = scene.cameras;
    EXPECT_EQ(solved(problem).model->cameras.size(), 8U);
}

}  // namespace
}  // namespace psfm
