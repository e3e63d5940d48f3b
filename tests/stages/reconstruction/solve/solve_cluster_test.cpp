// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/solve/solve_cluster.h"

#include <gtest/gtest.h>

#include "tests/stages/reconstruction/problems.h"
#include "tests/stages/reconstruction/two_streets.h"
#include "tests/synthetic/compare.h"
#include "tests/synthetic/disturb.h"
#include "tests/synthetic/verified_pairs.h"

namespace psfm {
namespace {

using synthetic::SyntheticScene;

SyntheticScene noisy_ring(std::uint32_t images, std::uint64_t seed) {
    return synthetic::add_clutter(
        synthetic::add_pixel_noise(
            synthetic::make_scene(synthetic::ring_around_sphere(images), seed), 0.3, seed),
        100, seed);
}

synthetic::ReconstructionError error_of(const ClusterSolution& solution,
                                        const SyntheticScene& scene) {
    const auto error = synthetic::compare_with_truth(*solution.model, scene);
    EXPECT_TRUE(error.ok());
    return error.ok() ? *error : synthetic::ReconstructionError{};
}

TEST(SolveCluster, ReconstructsARingWithNoiseAndWrongMatches) {
    const SyntheticScene scene = noisy_ring(12, 1);
    const auto pairs = synthetic::add_wrong_matches(scene, synthetic::make_verified_pairs(scene),
                                                    {.fraction = 0.1}, 5);
    ClusterProblem problem = problem_of(scene, pairs);
    problem.fix_intrinsics = true;
    problem.concluding = true;  // adjusted to convergence at once
    SolveOptions options;
    options.settling.adjustment.sigma_per_scale =
        0.0;  // the planted noise is the same at every scale
    const auto solution = solve_cluster(problem, options);
    ASSERT_TRUE(solution.ok()) << solution.error().message;
    EXPECT_EQ(solution->model->images.size(), 12U);
    EXPECT_TRUE(solution->waiting.empty());
    EXPECT_EQ(solution->statistics.kind, SolveKind::kNew);
    const auto error = error_of(*solution, scene);
    EXPECT_LT(error.max_position, 0.01);  // of a ring of 8 m radius
    EXPECT_LT(error.max_rotation_deg, 0.1);
}

TEST(SolveCluster, AFirstModelSettlesOnlyOnceNoPhotographFollows) {
    const SyntheticScene scene = noisy_ring(8, 1);
    ClusterProblem problem = problem_of(scene, synthetic::make_verified_pairs(scene));
    SolveOptions options;
    options.growth.max_rounds = 1;
    options.settling.max_rounds = 4;
    options.settling.max_change = 0.0;  // none of these is the last because little changed
    const auto growing = solve_cluster(problem, options);
    problem.concluding = true;
    const auto concluding = solve_cluster(problem, options);
    ASSERT_TRUE(growing.ok() && concluding.ok());
    EXPECT_EQ(growing->statistics.full_adjustments + 3, concluding->statistics.full_adjustments);
}

TEST(SolveCluster, RefinesFocalLengthAndDistortion) {
    const SyntheticScene scene = noisy_ring(12, 2);
    const auto guessed = synthetic::guessed_cameras(scene, 0.05, FocalSource::kExif, 3);
    const auto pairs = synthetic::make_verified_pairs(scene);
    ClusterProblem problem = problem_of(scene, pairs, guessed, 12);
    const auto solution = solve_cluster(problem, {});
    ASSERT_TRUE(solution.ok()) << solution.error().message;
    EXPECT_EQ(solution->model->images.size(), 12U);
    const Camera& refined = solution->model->cameras.begin()->second;
    const Camera& truth = scene.cameras.begin()->second;
    EXPECT_NEAR(refined.fx(), truth.fx(), 0.005 * truth.fx());
    EXPECT_NEAR(refined.params[3], truth.params[3], 0.01);
}

TEST(SolveCluster, CalibratesUnknownFocalLengths) {
    const SyntheticScene scene = noisy_ring(12, 3);
    std::map<CameraId, Camera> unknown;
    for (const auto& [id, camera] : scene.cameras)
        unknown[id] =
            make_camera(camera.width, camera.height, 1.2 * camera.width, FocalSource::kUnknown);
    const auto pairs = synthetic::make_verified_pairs(scene, {.calibrated = false});
    const auto solution = solve_cluster(problem_of(scene, pairs, unknown, 12), {});
    ASSERT_TRUE(solution.ok()) << solution.error().message;
    EXPECT_EQ(solution->model->images.size(), 12U);
    EXPECT_LT(error_of(*solution, scene).max_position, 0.05);
}

TEST(SolveCluster, ExtendsAModelAsWellAsSolvingAnew) {
    const SyntheticScene scene = noisy_ring(14, 4);
    const auto pairs = synthetic::make_verified_pairs(scene);
    ClusterProblem first = problem_of(scene, pairs, scene.cameras, 10);
    first.fix_intrinsics = true;
    const auto ten = solve_cluster(first, {});
    ASSERT_TRUE(ten.ok());
    ClusterProblem second = problem_of(scene, pairs);
    second.fix_intrinsics = true;
    second.recycled = {ten->model};
    second.recycled_state = ten->state;
    second.settle = true;
    const auto extended = solve_cluster(second, {});
    ASSERT_TRUE(extended.ok());
    EXPECT_EQ(extended->statistics.kind, SolveKind::kSettle);
    EXPECT_EQ(extended->statistics.registered, 4U);
    second.recycled.clear();
    const auto anew = solve_cluster(second, {});
    ASSERT_TRUE(anew.ok());
    EXPECT_EQ(extended->model->images.size(), 14U);
    EXPECT_LT(error_of(*extended, scene).max_position,
              1.15 * error_of(*anew, scene).max_position + 1e-4);
}

TEST(SolveCluster, IsBitwiseRepeatable) {
    const SyntheticScene scene = noisy_ring(8, 5);
    const ClusterProblem problem = problem_of(scene, synthetic::make_verified_pairs(scene));
    const auto a = solve_cluster(problem, {});
    const auto b = solve_cluster(problem, {});
    ASSERT_TRUE(a.ok() && b.ok());
    ASSERT_EQ(a->model->images.size(), b->model->images.size());
    for (std::size_t i = 0; i < a->model->images.size(); ++i) {
        EXPECT_EQ(a->model->images[i].cam_from_cluster.translation,
                  b->model->images[i].cam_from_cluster.translation);
    }
    ASSERT_EQ(a->model->points.size(), b->model->points.size());
    for (std::size_t i = 0; i < a->model->points.size(); ++i) {
        ASSERT_EQ(a->model->points[i].position, b->model->points[i].position);
    }
}

TEST(SolveCluster, DropsAnEdgeThatContradictsTheRotations) {
    const SyntheticScene scene = noisy_ring(12, 6);
    auto pairs = synthetic::make_verified_pairs(scene);
    // Not one that the spanning tree is made of: the weakest.
    const auto weakest = std::ranges::min_element(
        pairs, {}, [](const VerifiedPairPtr& pair) { return pair->geometry.inliers.size(); });
    VerifiedPair wrong = **weakest;
    wrong.geometry.cam2_from_cam1.rotation =
        Eigen::AngleAxisd(0.9, Eigen::Vector3d::UnitX()) * wrong.geometry.cam2_from_cam1.rotation;
    *weakest = std::make_shared<const VerifiedPair>(wrong);
    const auto solution = solve_cluster(problem_of(scene, pairs), {});
    ASSERT_TRUE(solution.ok());
    EXPECT_EQ(solution->statistics.removed_edges, 1U);
    EXPECT_EQ(solution->model->images.size(), 12U);
}

TEST(SolveCluster, SaysWhyImagesWait) {
    const SyntheticScene scene = noisy_ring(8, 7);
    const auto pairs = synthetic::make_verified_pairs(scene);
    const auto small = solve_cluster(problem_of(scene, pairs, scene.cameras, 2), {});
    ASSERT_TRUE(small.ok());
    EXPECT_TRUE(small->model->empty());
    ASSERT_EQ(small->waiting.size(), 2U);
    EXPECT_EQ(small->waiting.front().second, WaitReason::kClusterTooSmall);
    SolveOptions of_two;
    of_two.policy.mu_min = 2;
    const auto two = solve_cluster(problem_of(scene, pairs, scene.cameras, 2), of_two);
    ASSERT_TRUE(two.ok());
    EXPECT_TRUE(two->model->empty());
    EXPECT_EQ(two->waiting.size(), 2U);
    EXPECT_EQ(solve_cluster(problem_of(scene, pairs, scene.cameras, 3), {})->model->images.size(),
              3U);

    const auto unconnected = solve_cluster(problem_of(scene, {}), {});
    ASSERT_TRUE(unconnected.ok());
    ASSERT_EQ(unconnected->waiting.size(), 8U);
    EXPECT_EQ(unconnected->waiting.front().second, WaitReason::kNoSeed);

    auto without_last = pairs;
    std::erase_if(without_last,
                  [](const VerifiedPairPtr& pair) { return index_of(pair->pair.second) == 7; });
    const auto one_out = solve_cluster(problem_of(scene, without_last), {});
    ASSERT_TRUE(one_out.ok());
    ASSERT_EQ(one_out->waiting.size(), 1U);
    EXPECT_EQ(one_out->waiting.front(),
              std::pair(static_cast<ImageId>(7), WaitReason::kRegistrationFailed));
}

TEST(SolveCluster, StopsOnRequest) {
    const SyntheticScene scene = noisy_ring(8, 8);
    const std::atomic<bool> cancel{true};
    const auto solution =
        solve_cluster(problem_of(scene, synthetic::make_verified_pairs(scene)), {}, &cancel);
    ASSERT_FALSE(solution.ok());
    EXPECT_EQ(solution.error().code, ErrorCode::kCancelled);
}

TEST(SolveCluster, StopsSettlingOnRequest) {
    const SyntheticScene scene = noisy_ring(8, 8);
    ClusterProblem problem = problem_of(scene, synthetic::make_verified_pairs(scene));
    const auto solution = solve_cluster(problem, {});
    ASSERT_TRUE(solution.ok());
    problem.recycled = {solution->model};
    problem.recycled_state = solution->state;
    problem.settle = true;
    const std::atomic<bool> cancel{true};
    const auto settled = solve_cluster(problem, {}, &cancel);
    ASSERT_FALSE(settled.ok()) << "there is nothing to be added, only to be adjusted";
    EXPECT_EQ(settled.error().code, ErrorCode::kCancelled);
}

TEST(SolveCluster, RefusesBrokenProblems) {
    const SyntheticScene scene = noisy_ring(6, 9);
    ClusterProblem problem = problem_of(scene, {});
    std::swap(problem.images[0], problem.images[1]);
    EXPECT_EQ(solve_cluster(problem, {}).error().code, ErrorCode::kInvalidArgument);
    ClusterProblem no_camera = problem_of(scene, {});
    no_camera.cameras.clear();
    EXPECT_EQ(solve_cluster(no_camera, {}).error().code, ErrorCode::kInvalidArgument);
}

TEST(SolveCluster, AsksALargeModelThatHardlyChangedOnlyLaterOrWhenItSettles) {
    constexpr std::uint32_t kImages = 30;
    const SyntheticScene scene = two_streets(kImages, 0.4, 7);
    ClusterProblem problem = problem_of(scene, synthetic::make_verified_pairs(scene));
    problem.fix_intrinsics = true;
    std::vector<ImageId> kept;
    for (std::uint32_t image = 1; image < kImages; ++image) kept.push_back(ImageId{image});
    problem.recycled = {std::make_shared<const Reconstruction>(
        synthetic::true_reconstruction(scene, synthetic::random_gauge(5), kept))};
    problem.recycled_state = {.images_at_full_adjustment = kImages, .images_at_start = kImages};
    SolveOptions options;
    options.policy.affordable_up_to = 20;
    options.loops.min_open_edges = 0;
    options.policy.places.again_when_grown_by = 0.1;
    const auto solve = [&](std::uint32_t asked_with) {
        problem.recycled_state.images_at_places = asked_with;
        auto solved = solve_cluster(problem, options);
        EXPECT_TRUE(solved.ok());
        return solved.ok() ? *std::move(solved) : ClusterSolution{};
    };
    const ClusterSolution later = solve(kImages - 1);
    EXPECT_EQ(later.statistics.registered, 1U);
    EXPECT_TRUE(later.places.empty()) << "not asked";
    EXPECT_TRUE(later.state.has_strangers) << "what was added has not been looked at";
    EXPECT_EQ(later.state.images_at_places, kImages - 1);
    EXPECT_EQ(solve(kImages / 2).places.size(), 2U) << "it has changed";
    EXPECT_EQ(solve(0).places.size(), 2U) << "never asked";
    options.policy.affordable_up_to = kImages;
    EXPECT_EQ(solve(kImages - 1).places.size(), 2U) << "a small model";
    options.policy.affordable_up_to = 20;
    problem.settle = true;
    EXPECT_EQ(solve(kImages - 1).places.size(), 2U) << "it settles";
}

}  // namespace
}  // namespace psfm
