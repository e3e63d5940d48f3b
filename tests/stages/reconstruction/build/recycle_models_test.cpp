// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What a cluster's solve makes of the models that its images bring along: transfer, and reset.
#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "stages/reconstruction/solve/solve_cluster.h"
#include "tests/stages/reconstruction/problems.h"
#include "tests/synthetic/change_points.h"
#include "tests/synthetic/compare.h"
#include "tests/synthetic/disturb.h"
#include "tests/synthetic/verified_pairs.h"

namespace psfm {
namespace {

using synthetic::SyntheticScene;
using ModelPtr = std::shared_ptr<const Reconstruction>;

constexpr std::uint32_t kImages = 16;

SyntheticScene noisy_ring(std::uint64_t seed) {
    return synthetic::add_pixel_noise(
        synthetic::make_scene(synthetic::ring_around_sphere(kImages), seed), 0.3, seed);
}

std::vector<ImageId> range(std::uint32_t first, std::uint32_t last) {
    std::vector<ImageId> images;
    for (std::uint32_t i = first; i < last; ++i) images.push_back(ImageId{i});
    return images;
}

/// The true model of some images in a gauge of its own.
ModelPtr model_of(const SyntheticScene& scene, const std::vector<ImageId>& images,
                  std::uint64_t seed) {
    return std::make_shared<const Reconstruction>(
        synthetic::true_reconstruction(scene, synthetic::random_gauge(seed), images));
}

ClusterProblem ring_problem(const SyntheticScene& scene, std::vector<ModelPtr> recycled) {
    ClusterProblem problem = problem_of(scene, synthetic::make_verified_pairs(scene));
    problem.fix_intrinsics = true;
    problem.recycled = std::move(recycled);
    problem.recycled_state.images_at_full_adjustment =
        static_cast<std::uint32_t>(problem.recycled.front()->images.size());
    return problem;
}

double max_position_error(const ClusterSolution& solution, const SyntheticScene& scene) {
    const auto error = synthetic::compare_with_truth(*solution.model, scene);
    EXPECT_TRUE(error.ok());
    return error.ok() ? error->max_position : std::numeric_limits<double>::infinity();
}

/// Points that images before this one and images from it on see: two models had them apart.
std::size_t points_across(const Reconstruction& model, ImageId first_of_second) {
    std::size_t across = 0;
    for (const ScenePoint& point : model.points) {
        const auto in_second = [&](const Observation& o) { return o.image >= first_of_second; };
        const auto count = std::ranges::count_if(point.track, in_second);
        if (count > 0 && static_cast<std::size_t>(count) < point.track.size()) ++across;
    }
    return across;
}

TEST(RecycleModels, JoinsModelsOfDifferentGauges) {
    const SyntheticScene scene = noisy_ring(1);
    const ModelPtr first = model_of(scene, range(0, 9), 11);
    const ModelPtr second = model_of(scene, range(9, 14), 12);
    const auto solution = solve_cluster(ring_problem(scene, {first, second}), {});
    ASSERT_TRUE(solution.ok()) << solution.error().message;
    EXPECT_EQ(solution->statistics.kind, SolveKind::kTransfer);
    EXPECT_EQ(solution->statistics.joined_models, 1U);
    EXPECT_EQ(solution->statistics.left_models, 0U);
    EXPECT_EQ(solution->statistics.registered, 2U) << "the two images that neither model has";
    EXPECT_EQ(solution->model->images.size(), kImages);
    EXPECT_LT(max_position_error(*solution, scene), 0.02);  // of a ring of 8 m radius
    EXPECT_FALSE(solution->statistics.reset);
    EXPECT_GT(points_across(*solution->model, ImageId{9}), 50U);
}

TEST(RecycleModels, JoinsASmallModelByALocalAdjustment) {
    const SyntheticScene scene = noisy_ring(6);
    const ModelPtr base = model_of(scene, range(0, 13), 61);
    const ModelPtr small = model_of(scene, range(13, kImages), 62);
    SolveOptions options;
    options.policy.full_adjustment.again_when_grown_by = 0.5;
    const auto solution = solve_cluster(ring_problem(scene, {base, small}), options);
    ASSERT_TRUE(solution.ok()) << solution.error().message;
    EXPECT_EQ(solution->statistics.kind, SolveKind::kTransfer);
    EXPECT_EQ(solution->statistics.joined_models, 1U);
    EXPECT_EQ(solution->statistics.full_adjustments, 0U) << "it has not grown by so much";
    EXPECT_GT(solution->statistics.local_adjustments, 0U);
    EXPECT_EQ(solution->state.images_at_full_adjustment, 13U);
    EXPECT_EQ(solution->model->images.size(), kImages);
    EXPECT_LT(max_position_error(*solution, scene), 0.03);
    EXPECT_GT(points_across(*solution->model, ImageId{13}), 50U);
    options.policy.full_adjustment.again_when_grown_by = 0.15;
    const auto whole = solve_cluster(ring_problem(scene, {base, small}), options);
    EXPECT_GT(whole->statistics.full_adjustments, 0U);
    // What both models had is one point in either case.
    EXPECT_LT(static_cast<double>(solution->model->points.size()),
              1.02 * static_cast<double>(whole->model->points.size()));
}

TEST(RecycleModels, JoinsThroughAThirdModel) {
    // The small models at the ends see nothing in common; each finds its place beside the middle.
    const SyntheticScene scene = noisy_ring(2);
    const auto solution = solve_cluster(
        ring_problem(scene, {model_of(scene, range(0, 6), 21), model_of(scene, range(11, 16), 22),
                             model_of(scene, range(6, 11), 23)}),
        {});
    ASSERT_TRUE(solution.ok());
    EXPECT_EQ(solution->statistics.joined_models, 2U);
    EXPECT_EQ(solution->statistics.registered, 0U);
    EXPECT_LT(max_position_error(*solution, scene), 0.02);
}

TEST(RecycleModels, AddsTheImagesOfABrokenModelOneByOne) {
    const SyntheticScene scene = noisy_ring(3);
    Reconstruction broken = *model_of(scene, range(9, 16), 31);
    std::mt19937_64 rng(3);
    std::normal_distribution<double> normal;
    synthetic::change_points(broken, [&](std::vector<ScenePoint>& points) {
        for (ScenePoint& point : points)
            point.position += Eigen::Vector3d(normal(rng), normal(rng), normal(rng)) * 5.0;
    });
    const auto solution =
        solve_cluster(ring_problem(scene, {model_of(scene, range(0, 9), 32),
                                           std::make_shared<const Reconstruction>(broken)}),
                      {});
    ASSERT_TRUE(solution.ok());
    EXPECT_EQ(solution->statistics.left_models, 1U);
    EXPECT_EQ(solution->statistics.registered, 7U);
    EXPECT_EQ(solution->model->images.size(), kImages);
    EXPECT_LT(max_position_error(*solution, scene), 0.02);
}

/// No edge has points of both models at first: some images of the second have to be added to the
/// first by themselves, and the rest of it comes with them.
TEST(RecycleModels, JoinsAModelWithoutCommonPointsOnceSomeOfItsImagesAreThere) {
    constexpr std::uint32_t kMany = 32;
    const SyntheticScene scene = synthetic::add_pixel_noise(
        synthetic::make_scene(synthetic::ring_around_sphere(kMany), 8), 0.3, 8);
    const ModelPtr first = model_of(scene, range(0, 12), 81);
    const ModelPtr second = without_points_beyond(*model_of(scene, range(12, kMany), 82),
                                                  synthetic::make_verified_pairs(scene));
    const auto solution = solve_cluster(ring_problem(scene, {first, second}), {});
    ASSERT_TRUE(solution.ok());
    EXPECT_EQ(solution->statistics.kind, SolveKind::kTransfer);
    EXPECT_EQ(solution->statistics.joined_models, 1U);
    EXPECT_EQ(solution->statistics.left_models, 0U);
    EXPECT_GT(solution->statistics.registered, 0U);
    EXPECT_LE(solution->statistics.registered, 10U);
    EXPECT_EQ(solution->model->images.size(), kMany);
    EXPECT_LT(max_position_error(*solution, scene), 0.02);
}

/// The true model with the second half of the ring turned about the axis, as if it had been put on
/// a look-alike: right within each half.
ModelPtr folded_model(const SyntheticScene& scene) {
    const Sim3 fold{
        1.0,
        Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 3.0, Eigen::Vector3d::UnitZ())),
        Eigen::Vector3d::Zero()};
    Reconstruction model = synthetic::true_reconstruction(scene, Sim3{}, range(0, 8));
    const Reconstruction other = synthetic::true_reconstruction(scene, fold, range(8, kImages));
    model.images.insert(model.images.end(), other.images.begin(), other.images.end());
    model.points.append(other.points);
    return std::make_shared<const Reconstruction>(std::move(model));
}

TEST(RecycleModels, ResetsAModelThatContradictsTheRotations) {
    const SyntheticScene scene = noisy_ring(4);
    const auto solution = solve_cluster(ring_problem(scene, {folded_model(scene)}), {});
    ASSERT_TRUE(solution.ok());
    ASSERT_TRUE(solution->statistics.reset);
    EXPECT_TRUE(solution->statistics.reset->images.empty()) << "the whole cluster";
    EXPECT_NEAR(solution->statistics.reset->contradiction.angle_deg, 60.0, 5.0);
    EXPECT_GT(solution->statistics.reset->contradiction.beyond, 0U);
    EXPECT_EQ(solution->statistics.kind, SolveKind::kNew);
    EXPECT_EQ(solution->model->images.size(), kImages);
    EXPECT_LT(max_position_error(*solution, scene), 0.02);
}

TEST(RecycleModels, PutsOffTheResetOfALargeModelUntilItSettles) {
    const SyntheticScene scene = noisy_ring(4);
    SolveOptions options;
    options.policy.affordable_up_to = kImages - 1;
    options.loops.min_open_edges = 0;       // else it is closed
    options.max_contradicting_edges = 1.0;  // of so few edges many contradict
    ClusterProblem problem = ring_problem(scene, {folded_model(scene)});
    const auto before = solve_cluster(problem, options);
    ASSERT_TRUE(before.ok());
    EXPECT_FALSE(before->statistics.reset);
    EXPECT_TRUE(before->state.new_start_is_due);
    EXPECT_GT(max_position_error(*before, scene), 1.0) << "folded still";
    problem.recycled = {before->model};
    problem.recycled_state = before->state;
    EXPECT_FALSE(solve_cluster(problem, options)->statistics.reset) << "nor with the next image";
    problem.settle = true;
    const auto settled = solve_cluster(problem, options);
    ASSERT_TRUE(settled.ok());
    EXPECT_TRUE(settled->statistics.reset);
    EXPECT_FALSE(settled->state.new_start_is_due);
    EXPECT_LT(max_position_error(*settled, scene), 0.02);
}

/// Images that left a cluster while it was being solved, and came back with what they brought
/// along, are in both models.
TEST(RecycleModels, JoinsModelsThatShareImages) {
    const SyntheticScene scene = noisy_ring(6);
    const ModelPtr late = model_of(scene, range(5, kImages), 61);
    const ModelPtr early = model_of(scene, range(0, 10), 62);
    for (const auto& models : {std::vector{late, early}, std::vector{early, late}}) {
        const auto solution = solve_cluster(ring_problem(scene, models), {});
        ASSERT_TRUE(solution.ok());
        EXPECT_EQ(solution->statistics.joined_models, 1U);
        EXPECT_EQ(solution->statistics.left_models, 0U);
        EXPECT_EQ(solution->model->images.size(), kImages);
        EXPECT_LT(max_position_error(*solution, scene), 0.02);
    }
}

/// Both arms of the fold are right by themselves: only how they stand to each other is wrong.
TEST(RecycleModels, JoinsThePartsOfALargeFoldedModelAgain) {
    const SyntheticScene scene = noisy_ring(4);
    SolveOptions options;
    options.policy.large_from = kImages;
    const auto solution = solve_cluster(ring_problem(scene, {folded_model(scene)}), options);
    ASSERT_TRUE(solution.ok());
    ASSERT_TRUE(solution->statistics.reset);
    const std::vector<ImageId>& moved = solution->statistics.reset->images;
    EXPECT_GT(moved.size(), std::size_t{kImages / 10});
    EXPECT_LE(2 * moved.size(), std::size_t{kImages});
    EXPECT_EQ(solution->statistics.kind, SolveKind::kExtend) << "not solved new";
    EXPECT_EQ(solution->statistics.registered, 0U) << "and no image by itself";
    EXPECT_EQ(solution->model->images.size(), kImages);
    EXPECT_LT(max_position_error(*solution, scene), 0.02);
    EXPECT_LT(solution->state.tolerated_contradiction_deg, options.max_contradiction_deg);
}

/// As where models of several clusters are joined: large ones are not adjusted again and again.
TEST(RecycleModels, LargeFoldedModelsAreAdjustedRoughlyWhenTheyAreJoinedAgain) {
    const SyntheticScene scene = noisy_ring(4);
    SolveOptions options;
    options.policy.large_from = kImages;
    options.growth.max_rounds = 3;
    options.growth.max_change = 0.0;
    for (const auto& [adjust_all_up_to, adjustments] :
         {std::pair(kImages, 3U), std::pair(kImages - 1, 1U)}) {
        options.policy.affordable_up_to = adjust_all_up_to;
        const auto solution = solve_cluster(ring_problem(scene, {folded_model(scene)}), options);
        ASSERT_TRUE(solution.ok());
        ASSERT_TRUE(solution->statistics.reset);
        EXPECT_EQ(solution->statistics.full_adjustments, adjustments);
        EXPECT_LT(max_position_error(*solution, scene), 0.05);
    }
}

/// No similarity between the arms is believed.
TEST(RecycleModels, PartsThatNothingJoinsAreSolvedNew) {
    const SyntheticScene scene = noisy_ring(4);
    SolveOptions options;
    options.policy.large_from = kImages;
    options.transfer.min_edge_inliers = 1000000;
    const auto solution = solve_cluster(ring_problem(scene, {folded_model(scene)}), options);
    ASSERT_TRUE(solution.ok());
    ASSERT_TRUE(solution->statistics.reset);
    EXPECT_TRUE(solution->statistics.reset->images.empty());
    EXPECT_EQ(solution->statistics.kind, SolveKind::kNew);
    EXPECT_LT(max_position_error(*solution, scene), 0.02);
}

TEST(RecycleModels, PlacesAnewTheOneImageThatContradicts) {
    const SyntheticScene scene = noisy_ring(5);
    Reconstruction model = *model_of(scene, range(0, kImages), 51);
    RegisteredImage& wrong = model.images[6];
    wrong.cam_from_cluster.rotation =
        Eigen::Quaterniond(Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitY())) *
        wrong.cam_from_cluster.rotation;
    const auto solution = solve_cluster(
        ring_problem(scene, {std::make_shared<const Reconstruction>(std::move(model))}), {});
    ASSERT_TRUE(solution.ok());
    ASSERT_TRUE(solution->statistics.reset);
    EXPECT_EQ(solution->statistics.reset->images, std::vector{ImageId{6}});
    EXPECT_EQ(solution->statistics.kind, SolveKind::kExtend);
    EXPECT_EQ(solution->statistics.registered, 1U);
    EXPECT_EQ(solution->model->images.size(), kImages);
    EXPECT_LT(max_position_error(*solution, scene), 0.02);
    EXPECT_LT(solution->state.tolerated_contradiction_deg, SolveOptions{}.max_contradiction_deg);
}

TEST(RecycleModels, SolvesNewWhereImagesMayNotBePlacedAnew) {
    const SyntheticScene scene = noisy_ring(5);
    Reconstruction model = *model_of(scene, range(0, kImages), 51);
    model.images[6].cam_from_cluster.rotation = model.images[14].cam_from_cluster.rotation;
    SolveOptions options;
    options.max_reset_images = 0.0;
    const auto solution = solve_cluster(
        ring_problem(scene, {std::make_shared<const Reconstruction>(std::move(model))}), options);
    ASSERT_TRUE(solution.ok());
    ASSERT_TRUE(solution->statistics.reset);
    EXPECT_TRUE(solution->statistics.reset->images.empty());
    EXPECT_EQ(solution->statistics.kind, SolveKind::kNew);
    EXPECT_LT(max_position_error(*solution, scene), 0.02);
}

TEST(RecycleModels, KeepsAnImageThatContradictsAsMuchWhenItIsPlacedAnew) {
    const SyntheticScene scene = noisy_ring(7);
    ClusterProblem problem = ring_problem(scene, {model_of(scene, range(0, kImages), 71)});
    // All edges of one image agree on a rotation that its matches contradict.
    constexpr ImageId kWrong{6};
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitY()));
    std::vector<VerifiedPairPtr> pairs = pairs_of(problem);
    for (VerifiedPairPtr& pair : pairs) {
        if (pair->pair.first != kWrong && pair->pair.second != kWrong) continue;
        VerifiedPair wrong = *pair;
        Eigen::Quaterniond& rotation = wrong.geometry.cam2_from_cam1.rotation;
        rotation = pair->pair.second == kWrong ? turn * rotation : rotation * turn.conjugate();
        pair = std::make_shared<const VerifiedPair>(wrong);
    }
    problem.view_graph = ViewGraph(pairs);
    const auto kept = solve_cluster(problem, {});
    ASSERT_TRUE(kept.ok());
    EXPECT_FALSE(kept->statistics.reset) << "neither placed anew nor solved new is better";
    EXPECT_EQ(kept->statistics.kind, SolveKind::kExtend);
    EXPECT_GT(kept->state.tolerated_contradiction_deg, SolveOptions{}.max_contradiction_deg);
    EXPECT_LT(max_position_error(*kept, scene), 0.02);
    SolveOptions tolerant;
    tolerant.max_contradicting_edges = 0.5;
    const auto placed_anew = solve_cluster(problem, tolerant);
    ASSERT_TRUE(placed_anew.ok());
    ASSERT_TRUE(placed_anew->statistics.reset);
    EXPECT_EQ(placed_anew->statistics.reset->images, std::vector{kWrong});
}

TEST(RecycleModels, DoesNotSolveNewAgainWhatWasComparedBefore) {
    const SyntheticScene scene = noisy_ring(4);
    ClusterProblem problem = ring_problem(scene, {folded_model(scene)});
    problem.recycled_state.tolerated_contradiction_deg = 60.0;
    problem.recycled_state.images_at_contradiction = kImages;
    const auto again = solve_cluster(problem, {});
    ASSERT_TRUE(again.ok());
    EXPECT_FALSE(again->statistics.reset);
    EXPECT_EQ(again->statistics.kind, SolveKind::kExtend);
    // Larger by more than a quarter since: worth another look.
    problem.recycled_state.images_at_contradiction = kImages / 2;
    const auto grown = solve_cluster(problem, {});
    ASSERT_TRUE(grown.ok());
    EXPECT_TRUE(grown->statistics.reset);
}

/// Three cameras of one point each: a model that nothing can be added to.
ModelPtr model_that_cannot_grow(const SyntheticScene& scene) {
    Reconstruction model = *model_of(scene, range(0, 3), 61);
    synthetic::change_points(model, [](std::vector<ScenePoint>& points) { points.resize(1); });
    return std::make_shared<const Reconstruction>(std::move(model));
}

TEST(RecycleModels, StartsAnewWhereMostImagesCannotBeAdded) {
    const SyntheticScene scene = noisy_ring(6);
    const auto solution = solve_cluster(ring_problem(scene, {model_that_cannot_grow(scene)}), {});
    ASSERT_TRUE(solution.ok());
    ASSERT_TRUE(solution->statistics.reset);
    EXPECT_EQ(solution->statistics.reset->reason, Reset::Reason::kStuck);
    EXPECT_EQ(solution->statistics.reset->placed_before, 3U);
    EXPECT_EQ(solution->model->images.size(), kImages);
    EXPECT_EQ(solution->state.images_at_start, kImages);
    EXPECT_LT(max_position_error(*solution, scene), 0.02);
}

TEST(RecycleModels, DoesNotStartAnewBeforeTheClusterHasGrown) {
    const SyntheticScene scene = noisy_ring(6);
    ClusterProblem problem = ring_problem(scene, {model_that_cannot_grow(scene)});
    problem.recycled_state.images_at_start = kImages - 3;  // less than a quarter since
    const auto solution = solve_cluster(problem, {});
    ASSERT_TRUE(solution.ok());
    EXPECT_FALSE(solution->statistics.reset);
    EXPECT_EQ(solution->model->images.size(), 3U);
}

}  // namespace
}  // namespace psfm
