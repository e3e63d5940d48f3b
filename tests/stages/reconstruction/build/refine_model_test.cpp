// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/build/refine_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <iterator>
#include <vector>

#include "stages/reconstruction/adjust/bundle_adjustment.h"
#include "stages/reconstruction/model/tracks.h"
#include "stages/reconstruction/solve/solve_cluster.h"
#include "tests/stages/reconstruction/problems.h"
#include "tests/stages/reconstruction/scene_model.h"
#include "tests/synthetic/compare.h"
#include "tests/synthetic/disturb.h"
#include "tests/synthetic/verified_pairs.h"

namespace psfm {
namespace {

using synthetic::SyntheticScene;

constexpr std::uint32_t kImages = 40;

SyntheticScene noisy_wall(std::uint64_t seed) {
    return synthetic::add_pixel_noise(
        synthetic::make_scene(synthetic::line_along_wall(kImages), seed), 0.3, seed);
}

std::vector<Rigid3> poses_of(const WorkingModel& model) {
    std::vector<Rigid3> poses;
    for (std::uint32_t image = 0; image < model.image_count(); ++image)
        poses.push_back(model.pose(image));
    return poses;
}

/// Images whose poses differ, ascending.
std::vector<std::uint32_t> moved_images(const std::vector<Rigid3>& before,
                                        const WorkingModel& model) {
    std::vector<std::uint32_t> moved;
    for (std::uint32_t image = 0; image < before.size(); ++image) {
        if (before[image].translation != model.pose(image).translation) moved.push_back(image);
    }
    return moved;
}

double mean_error(const SceneModel& wall) {
    const auto error = synthetic::compare_with_truth(wall.model->save(), wall.scene);
    EXPECT_TRUE(error.ok());
    return error.ok() ? error->mean_position : 1e9;
}

/// Whose intrinsics are held.
RefineContext held(const SolveOptions& options) {
    return {.options = options, .fix_intrinsics = true};
}

const SolveOptions kDefaults;

/// The plan of a model of all images.
SolvePlan planned(const SolveOptions& options) {
    return plan_solve(ClusterProblem{}, SolveState{}, kImages, options.policy);
}

TEST(RefineAround, MovesImagesAndTheirNeighboursOnly) {
    const SceneModel wall(noisy_wall(1));
    wall.disturb(0.005, 2);
    const auto before = poses_of(*wall.model);
    SolveOptions options;
    const auto adjustments = refine_around(*wall.model, {20}, 0, held(options));
    ASSERT_TRUE(adjustments.ok());
    EXPECT_GT(*adjustments, 0U);
    const auto moved = moved_images(before, *wall.model);
    EXPECT_TRUE(std::ranges::binary_search(moved, 20U));
    EXPECT_GE(moved.size(), 3U);
    EXPECT_LT(moved.size(), kImages / 3);
    EXPECT_EQ(moved.back() - moved.front() + 1, moved.size()) << "one stretch of the wall";

    const auto further = refine_around(*wall.model, {20}, moved.size() + 1, held(options));
    ASSERT_TRUE(further.ok());
    const auto more = moved_images(before, *wall.model);
    EXPECT_GT(more.size(), moved.size()) << "neighbours of neighbours";
    EXPECT_LT(more.size(), kImages);
}

TEST(RefineAround, DoesSoManyRoundsAsALargeModelIsGiven) {
    SolveOptions options;
    options.large_growth.max_change = 0.0;  // no round is the last because little changed
    for (const int rounds : {1, 3}) {
        const SceneModel wall(noisy_wall(1));
        wall.disturb(0.005, 2);
        options.large_growth.max_rounds = rounds;
        const auto adjustments = refine_around(*wall.model, {20}, 0, held(options));
        ASSERT_TRUE(adjustments.ok());
        EXPECT_EQ(*adjustments, static_cast<std::uint32_t>(rounds));
    }
}

TEST(RefineAround, AdjustsAllWhereThatIsNearlyAll) {
    const SceneModel wall(noisy_wall(1));
    wall.disturb(0.005, 2);
    const double disturbed = mean_error(wall);
    const auto before = poses_of(*wall.model);
    ASSERT_TRUE(refine_around(*wall.model, {20}, kImages, held(kDefaults)).ok());
    EXPECT_GE(moved_images(before, *wall.model).size(), kImages - 1) << "but for the gauge";
    EXPECT_LT(mean_error(wall), disturbed);
}

TEST(RefineAround, WhatIsNearlyAllIsAnOption) {
    const SceneModel wall(noisy_wall(1));
    wall.disturb(0.005, 2);
    const auto before = poses_of(*wall.model);
    SolveOptions options;
    options.max_region = 0.05;
    ASSERT_TRUE(refine_around(*wall.model, {20}, 0, held(options)).ok());
    EXPECT_GE(moved_images(before, *wall.model).size(), kImages - 1) << "but for the gauge";
}

TEST(RefineAround, CountsOnlyImagesThatAreThere) {
    const SceneModel wall(noisy_wall(1));
    wall.model->remove_image(20);
    const auto adjustments = refine_around(*wall.model, {20}, 0, held(kDefaults));
    ASSERT_TRUE(adjustments.ok());
    EXPECT_EQ(*adjustments, 0U);
}

TEST(RefineJoined, MovesAllThatWasJoinedAndTheJoint) {
    const SceneModel wall(noisy_wall(8));
    wall.disturb(0.005, 9);
    const auto before = poses_of(*wall.model);
    std::vector<std::uint32_t> joined;
    for (std::uint32_t image = 28; image < kImages; ++image) joined.push_back(image);
    SolveOptions options;
    options.policy.affordable_up_to = 30;
    options.images_around_joint = 0;
    const std::vector<std::uint32_t> joint{26, 27, 28, 29};
    ASSERT_TRUE(refine_joined(*wall.model, {.joined = 1, .images = joined, .joint = joint},
                              planned(options), held(options))
                    .ok());
    const auto moved = moved_images(before, *wall.model);
    EXPECT_EQ(moved.back(), kImages - 1) << "its far end, which nothing else holds";
    EXPECT_TRUE(std::ranges::binary_search(moved, 26U));
    EXPECT_GT(moved.front(), 15U);
}

TEST(RefineModel, RoundsBeforeTheLastOneMayBeRough) {
    SolveOptions rough;
    rough.settling.round_tolerance = 0.5;
    SolveOptions fine;
    fine.settling.round_tolerance = 0.0;
    const SceneModel one(noisy_wall(7));
    const SceneModel other(noisy_wall(7));
    one.disturb(0.005, 3);
    other.disturb(0.005, 3);
    ASSERT_TRUE(refine_model(*one.model, rough.settling, {.options = rough}).ok());
    ASSERT_TRUE(refine_model(*other.model, fine.settling, {.options = fine}).ok());
    EXPECT_NEAR(mean_error(one), mean_error(other), 0.02 * mean_error(other));
}

TEST(RefineGrown, TakesFewStepsForWhatIsLargerThanConvergeUpTo) {
    SolveOptions options;
    options.growth.max_rounds = 3;
    options.growth.max_change = 0.0;
    const std::vector<std::uint32_t> images{20, 21};
    for (const auto& [converge_up_to, rounds] :
         {std::pair(kImages, 3U), std::pair(kImages - 1, 1U)}) {
        options.policy.converge_up_to = converge_up_to;
        const SceneModel wall(noisy_wall(3));
        wall.disturb(0.005, 4);
        const auto before = poses_of(*wall.model);
        const auto grown = refine_grown(*wall.model, 4, planned(options), held(options));
        ASSERT_TRUE(grown.ok());
        EXPECT_EQ(*grown, rounds);
        EXPECT_GE(moved_images(before, *wall.model).size(), kImages - 1) << "all of it";
        const auto joined =
            refine_joined(*wall.model, {.joined = 1, .images = images, .joint = images},
                          planned(options), held(options));
        ASSERT_TRUE(joined.ok());
        EXPECT_EQ(*joined, rounds);
    }
}

/// Seconds to a minute of a model of thousands, which a stop does not wait for.
TEST(RefineModel, EveryWayOfAdjustingEndsWhenItIsCancelled) {
    const SceneModel wall(noisy_wall(8));
    const std::atomic<bool> cancel = true;
    const std::vector<std::uint32_t> images{20, 21};
    for (const std::uint32_t adjust_all_up_to : {kImages, kImages - 1}) {
        SolveOptions options;
        options.policy.affordable_up_to = adjust_all_up_to;
        const RefineContext context{options, true, &cancel};
        for (const auto& done :
             {refine_model(*wall.model, options.growth, context),
              refine_around(*wall.model, images, 0, context),
              refine_joined(*wall.model, {.joined = 1, .images = images, .joint = images},
                            planned(options), context),
              refine_grown(*wall.model, 4, planned(options), context),
              refine_locally(*wall.model, images, context),
              refine_joined_locally(*wall.model, images, context)}) {
            ASSERT_FALSE(done.ok());
            EXPECT_EQ(done.error().code, ErrorCode::kCancelled);
        }
    }
}

TEST(RefineLocally, SaysWhereThereIsNoSolution) {
    const SceneModel wall(noisy_wall(8));
    constexpr std::uint32_t kImage = 20;
    const std::vector<std::uint32_t> seen = points_seen_by(*wall.model, std::span(&kImage, 1));
    ASSERT_FALSE(seen.empty());
    const auto before = refine_locally(*wall.model, std::span(&kImage, 1), held(kDefaults));
    ASSERT_TRUE(before.ok());
    EXPECT_GT(*before, 0U);
    // All that it sees is behind it, and nothing else can be made of its matches.
    const Eigen::Vector3d center = wall.model->pose(kImage).target_origin_in_source();
    for (const std::uint32_t point : seen)
        wall.model->set_position(point, 2.0 * center - wall.model->points()[point].position);
    SolveOptions options;
    options.tracks.max_error_px = 0.0;
    for (const auto& adjusted :
         {refine_locally(*wall.model, std::span(&kImage, 1), held(options)),
          refine_joined_locally(*wall.model, std::span(&kImage, 1), held(options))}) {
        ASSERT_FALSE(adjusted.ok());
        EXPECT_EQ(adjusted.error().code, ErrorCode::kDegenerate);
    }
}

TEST(RefineGrown, AdjustsASmallModelWholeAndALargeOneWhereItHasGrown) {
    SolveOptions options;
    options.policy.affordable_up_to = kImages;
    const SceneModel small(noisy_wall(3));
    small.disturb(0.005, 4);
    auto before = poses_of(*small.model);
    ASSERT_TRUE(refine_grown(*small.model, 4, planned(options), held(options)).ok());
    EXPECT_GE(moved_images(before, *small.model).size(), kImages - 1);

    options.policy.affordable_up_to = kImages - 1;
    const SceneModel large(noisy_wall(3));
    large.disturb(0.005, 4);
    before = poses_of(*large.model);
    ASSERT_TRUE(refine_grown(*large.model, 4, planned(options), held(options)).ok());
    const auto moved = moved_images(before, *large.model);
    EXPECT_EQ(moved.back(), kImages - 1) << "the newest";
    EXPECT_GT(moved.size(), 4U) << "and their neighbours";
    EXPECT_LT(moved.size(), kImages / 2);
}

TEST(Adjust, HoldsPointsOfLongTracksWhereOneImageIsAdded) {
    const SceneModel wall(noisy_wall(6));
    const std::vector<std::uint32_t> added{20};
    AdjustmentScope scope = local_scope(*wall.model, added, 5, 15, false);
    EXPECT_EQ(scope.longest_moving_track, 15U);
    EXPECT_EQ(full_scope(*wall.model, false).longest_moving_track, 0U) << "all move";
    scope.longest_moving_track = 3;
    const auto seen = points_seen_by(*wall.model, added);
    std::vector<Eigen::Vector3d> before;
    before.reserve(seen.size());
    for (const std::uint32_t point : seen) before.push_back(wall.model->points()[point].position);
    ASSERT_TRUE(adjust(*wall.model, scope, {}).ok());
    std::size_t held = 0;
    for (std::size_t i = 0; i < seen.size(); ++i) {
        const WorkingModel::Point& point = wall.model->points()[seen[i]];
        const bool is_long = point.track.size() > 3;
        EXPECT_EQ(point.position == before[i], is_long);
        held += is_long ? 1 : 0;
    }
    EXPECT_GT(held, 20U);
    EXPECT_LT(held, seen.size());
}

TEST(FilterTracks, LooksAtAllOfATrackOnlyWhereThePointHasChanged) {
    const SceneModel wall(noisy_wall(7));
    Rigid3 moved = wall.model->pose(21);
    moved.translation.x() += 1.0;  // all that it sees is wrong now
    wall.model->set_pose(21, moved);
    std::vector<std::uint32_t> shared;
    std::ranges::set_intersection(points_seen_by(*wall.model, std::vector<std::uint32_t>{20}),
                                  points_seen_by(*wall.model, std::vector<std::uint32_t>{21}),
                                  std::back_inserter(shared));
    std::erase_if(shared,
                  [&](std::uint32_t p) { return wall.model->points()[p].track.size() < 3; });
    ASSERT_GT(shared.size(), 10U);
    const auto seen_by_moved = [&](std::uint32_t p) {
        return std::ranges::any_of(wall.model->points()[p].track,
                                   [](const auto& feature) { return feature.image == 21; });
    };
    const std::uint32_t changed = shared.front();
    wall.model->set_position(changed, wall.model->points()[changed].position);
    filter_tracks(*wall.model, std::vector<std::uint32_t>{20}, {});
    EXPECT_FALSE(seen_by_moved(changed));
    EXPECT_TRUE(std::all_of(shared.begin() + 1, shared.end(), seen_by_moved))
        << "neither they nor image 20 have changed";
    filter_tracks(*wall.model, std::vector<std::uint32_t>{21}, {});
    EXPECT_TRUE(std::none_of(shared.begin(), shared.end(), seen_by_moved));
}

TEST(SolveCluster, AdjustsLargeModelsAroundTheirJoint) {
    const SyntheticScene scene = noisy_wall(5);
    ClusterProblem problem = problem_of(scene, synthetic::make_verified_pairs(scene));
    problem.fix_intrinsics = true;
    const auto model_of = [&](std::uint32_t first, std::uint32_t last, std::uint64_t gauge) {
        std::vector<ImageId> images;
        for (std::uint32_t i = first; i < last; ++i) images.push_back(ImageId{i});
        return std::make_shared<const Reconstruction>(
            synthetic::true_reconstruction(scene, synthetic::random_gauge(gauge), images));
    };
    const auto base = model_of(0, 22, 1);
    problem.recycled = {base, model_of(22, kImages, 2)};
    problem.recycled_state.images_at_full_adjustment = 22;
    SolveOptions options;
    options.policy.affordable_up_to = 30;
    options.images_around_joint = 10;
    const auto solution = solve_cluster(problem, options);
    ASSERT_TRUE(solution.ok());
    EXPECT_EQ(solution->statistics.joined_models, 1U);
    EXPECT_GT(solution->statistics.full_adjustments, 0U);
    EXPECT_EQ(solution->state.images_at_full_adjustment, kImages);
    const auto moved_by = [&](ImageId image) {
        return (solution->model->find(image)->cam_from_cluster.target_origin_in_source() -
                base->find(image)->cam_from_cluster.target_origin_in_source())
            .norm();
    };
    EXPECT_LT(moved_by(ImageId{0}), 1e-9) << "far from the joint";
    EXPECT_GT(moved_by(ImageId{21}), 1e-4);
    const auto error = synthetic::compare_with_truth(*solution->model, scene);
    ASSERT_TRUE(error.ok());
    EXPECT_LT(error->max_position, 0.1);  // of a wall of 80 m
}

}  // namespace
}  // namespace psfm
