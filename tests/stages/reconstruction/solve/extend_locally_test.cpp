// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/solve/extend_locally.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "stages/reconstruction/checks/separate_places.h"
#include "stages/reconstruction/model/surroundings.h"
#include "stages/reconstruction/solve/solve_cluster.h"
#include "tests/stages/reconstruction/problems.h"
#include "tests/stages/reconstruction/two_streets.h"
#include "tests/synthetic/compare.h"
#include "tests/synthetic/disturb.h"
#include "tests/synthetic/verified_pairs.h"

namespace psfm {
namespace {

using synthetic::SyntheticScene;

constexpr std::uint32_t kImages = 30;
constexpr ImageId kNew{14};  // in the middle of the wall
constexpr ImageId kFar{0};

SyntheticScene noisy_wall(std::uint64_t seed) {
    return synthetic::add_pixel_noise(
        synthetic::make_scene(synthetic::line_along_wall(kImages), seed), 0.3, seed);
}

/// The true model of all images but some, to be extended by these.
ClusterProblem problem_without(const SyntheticScene& scene, const std::vector<ImageId>& left_out) {
    ClusterProblem problem = problem_of(scene, synthetic::make_verified_pairs(scene));
    problem.fix_intrinsics = true;
    std::vector<ImageId> kept;
    for (const ClusterImage& image : problem.images) {
        if (std::ranges::find(left_out, image.id) == left_out.end()) kept.push_back(image.id);
    }
    problem.recycled = {std::make_shared<const Reconstruction>(
        synthetic::true_reconstruction(scene, synthetic::random_gauge(5), kept))};
    problem.recycled_state.images_at_full_adjustment = static_cast<std::uint32_t>(kept.size());
    return problem;
}

SolveOptions locally_from(std::uint32_t images) {
    SolveOptions options;
    options.policy.large_from = images;
    return options;
}

/// REQUIRES: the solve succeeds
std::optional<SolveAttempt> extended(const ClusterProblem& problem, const SolveOptions& options) {
    if (plan_solve(problem, options.policy).scope != SolveScope::kSurroundings) return std::nullopt;
    auto attempt = extend_locally(problem, options, nullptr);
    EXPECT_TRUE(attempt.ok());
    return attempt.ok() ? *std::move(attempt) : std::nullopt;
}

bool sees(const ScenePoint& point, ImageId image) {
    return std::ranges::any_of(point.track, [&](const auto& o) { return o.image == image; });
}

TEST(Surroundings, HoldAllThatNeighboursSee) {
    const SyntheticScene scene = noisy_wall(1);
    const ClusterProblem problem = problem_without(scene, {kNew});
    const auto surroundings = surroundings_of_new_images(problem, SolveOptions{}.max_surroundings);
    ASSERT_TRUE(surroundings);
    const ClusterProblem& part = surroundings->problem;
    const Reconstruction& whole = *problem.recycled.front();
    std::vector<ImageId> neighbors;
    for (const VerifiedPairPtr& pair : pairs_of(problem)) {
        if (pair->pair.first == kNew) neighbors.push_back(pair->pair.second);
        if (pair->pair.second == kNew) neighbors.push_back(pair->pair.first);
    }
    ASSERT_GT(neighbors.size(), 3U);
    const auto is_member = [&](ImageId image) {
        return std::ranges::binary_search(part.images, image, {}, &ClusterImage::id);
    };
    std::size_t inside = 0;
    for (std::size_t p = 0; p < whole.points.size(); ++p) {
        const bool seen = std::ranges::any_of(
            neighbors, [&](ImageId image) { return sees(whole.points[p], image); });
        EXPECT_EQ(surroundings->is_inside[p] != 0, seen);
        if (!seen) continue;
        EXPECT_EQ(part.recycled.front()->points[inside++].track, whole.points[p].track)
            << "whoever else sees it holds it where it is";
        for (const Observation& o : whole.points[p].track) EXPECT_TRUE(is_member(o.image));
    }
    EXPECT_EQ(part.recycled.front()->points.size(), inside);
    EXPECT_TRUE(is_member(kNew));
    EXPECT_FALSE(is_member(kFar));
    EXPECT_GT(part.images.size(), neighbors.size() + 1) << "observers that are no neighbours";
    neighbors.push_back(kNew);
    for (const VerifiedPairPtr& pair : pairs_of(part)) {
        EXPECT_NE(std::ranges::find(neighbors, pair->pair.first), neighbors.end());
        EXPECT_NE(std::ranges::find(neighbors, pair->pair.second), neighbors.end());
    }
    EXPECT_TRUE(part.held_cameras.contains(scene.images.front().camera)) << "others share it";
}

TEST(Surroundings, ThatAreMostOfTheModelAreNone) {
    const SyntheticScene scene = noisy_wall(1);
    std::vector<ImageId> every_fourth;
    for (std::uint32_t i = 0; i < kImages; i += 4) every_fourth.push_back(ImageId{i});
    EXPECT_FALSE(surroundings_of_new_images(problem_without(scene, every_fourth),
                                            SolveOptions{}.max_surroundings));
    EXPECT_FALSE(
        surroundings_of_new_images(problem_without(scene, {}), SolveOptions{}.max_surroundings))
        << "nothing is new";
}

TEST(ExtendLocally, AddsAnImageAsASolveOfAllWould) {
    const SyntheticScene scene = noisy_wall(2);
    const ClusterProblem problem = problem_without(scene, {kNew});
    const auto local = extended(problem, locally_from(20));
    ASSERT_TRUE(local);
    EXPECT_EQ(local->statistics.registered, 1U);
    EXPECT_EQ(local->statistics.kind, SolveKind::kExtend);
    ASSERT_TRUE(local->places) << "its images stand beside no strangers";
    EXPECT_TRUE(local->places->empty());
    const auto whole = solve_cluster(problem, SolveOptions{});
    ASSERT_TRUE(whole.ok());
    ASSERT_EQ(local->model.images.size(), whole->model->images.size());
    // The same operations on the same observations; only the order of points differs.
    EXPECT_EQ(local->model.points.size(), whole->model->points.size());
    for (std::size_t i = 0; i < whole->model->images.size(); ++i) {
        EXPECT_EQ(local->model.images[i].image, whole->model->images[i].image);
        EXPECT_LT((local->model.images[i].cam_from_cluster.target_origin_in_source() -
                   whole->model->images[i].cam_from_cluster.target_origin_in_source())
                      .norm(),
                  1e-6);
    }
    const auto error = synthetic::compare_with_truth(local->model, scene);
    ASSERT_TRUE(error.ok());
    EXPECT_LT(error->max_position, 0.02);
}

TEST(ExtendLocally, IsWhatALargeModelIsSolvedBy) {
    const SyntheticScene scene = noisy_wall(2);
    const ClusterProblem problem = problem_without(scene, {kNew});
    const auto local = extended(problem, locally_from(20));
    const auto solution = solve_cluster(problem, locally_from(20));
    ASSERT_TRUE(local && solution.ok());
    const ScenePoints& points = solution->model->points;
    ASSERT_EQ(points.size(), local->model.points.size());
    EXPECT_EQ(points[points.size() - 1].track, local->model.points[points.size() - 1].track)
        << "points that the image sees come last";
    EXPECT_TRUE(solution->waiting.empty());
}

TEST(ExtendLocally, LeavesTheRestOfTheModelAsItIs) {
    const SyntheticScene scene = noisy_wall(3);
    const ClusterProblem problem = problem_without(scene, {kNew});
    const auto local = extended(problem, locally_from(20));
    ASSERT_TRUE(local);
    const Reconstruction& before = *problem.recycled.front();
    EXPECT_EQ(local->model.find(kFar)->cam_from_cluster.translation,
              before.find(kFar)->cam_from_cluster.translation);
    const auto seen_from_afar = [](const Reconstruction& model) {
        std::vector<ScenePoint> points;
        std::ranges::copy_if(model.points, std::back_inserter(points),
                             [](const ScenePoint& point) { return sees(point, kFar); });
        return points;
    };
    const auto kept = seen_from_afar(local->model);
    const auto known = seen_from_afar(before);
    ASSERT_EQ(kept.size(), known.size());
    EXPECT_GT(kept.size(), 50U);
    for (std::size_t p = 0; p < kept.size(); ++p) {
        EXPECT_EQ(kept[p].position, known[p].position);
        EXPECT_EQ(kept[p].track, known[p].track);
    }
    EXPECT_EQ(local->model.cameras.size(), before.cameras.size());
}

TEST(ExtendLocally, TellsWhatOfTheModelIsAsItWas) {
    const SyntheticScene scene = noisy_wall(3);
    const ClusterProblem problem = problem_without(scene, {kNew});
    const auto solution = solve_cluster(problem, locally_from(20));
    ASSERT_TRUE(solution.ok());
    ASSERT_TRUE(solution->succession);
    EXPECT_EQ(solution->succession->before, problem.recycled.front());
    const ScenePoints& before = problem.recycled.front()->points;
    ASSERT_EQ(solution->succession->replaced.size(), before.size());
    std::size_t kept = 0;
    for (std::size_t p = 0; p < before.size(); ++p) {
        if (solution->succession->replaced[p] != 0) continue;
        const ScenePoint& point = solution->model->points[kept++];
        EXPECT_EQ(point.position, before[p].position);
        EXPECT_EQ(point.error_px, before[p].error_px);
        EXPECT_EQ(point.track, before[p].track);
    }
    EXPECT_GT(kept, before.size() / 4);
    EXPECT_LT(kept, before.size());
    for (const RegisteredImage& image : problem.recycled.front()->images)
        EXPECT_NE(solution->model->find(image.image), nullptr);

    const auto of_all = solve_cluster(problem, SolveOptions{});
    ASSERT_TRUE(of_all.ok());
    EXPECT_FALSE(of_all->succession) << "all of it may have moved";
}

TEST(ExtendLocally, RefinesNoCameraThatOthersShare) {
    SyntheticScene scene = noisy_wall(4);
    constexpr CameraId kShared{77};
    scene.cameras[kShared] = scene.cameras.begin()->second;
    scene.images[index_of(kNew)].camera = kShared;
    const auto refines = [&] {
        ClusterProblem problem = problem_without(scene, {kNew});
        problem.fix_intrinsics = false;
        const auto local = extended(problem, locally_from(20));
        EXPECT_TRUE(local && local->statistics.registered == 1);
        return local && local->model.cameras.at(kShared).params != scene.cameras.at(kShared).params;
    };
    EXPECT_TRUE(refines()) << "no other image has it";
    scene.images[index_of(kFar)].camera = kShared;
    EXPECT_FALSE(refines()) << "an image has it that does not take part";
}

TEST(ExtendLocally, JoinsASmallModel) {
    const SyntheticScene scene = noisy_wall(8);
    const std::vector<ImageId> small{ImageId{27}, ImageId{28}, ImageId{29}};
    ClusterProblem problem = problem_without(scene, small);
    problem.recycled.push_back(std::make_shared<const Reconstruction>(
        synthetic::true_reconstruction(scene, synthetic::random_gauge(6), small)));
    const auto local = extended(problem, locally_from(20));
    ASSERT_TRUE(local);
    EXPECT_EQ(local->statistics.kind, SolveKind::kTransfer);
    EXPECT_EQ(local->statistics.joined_models, 1U);
    EXPECT_EQ(local->statistics.registered, 0U) << "none one by one";
    EXPECT_EQ(local->model.images.size(), kImages);
    EXPECT_EQ(local->model.find(kFar)->cam_from_cluster.translation,
              problem.recycled.front()->find(kFar)->cam_from_cluster.translation);
    const auto both = [](const ScenePoint& point) {
        return sees(point, ImageId{26}) && sees(point, ImageId{27});
    };
    EXPECT_GT(std::ranges::count_if(local->model.points, both), 20) << "tracks are joined, too";
    const auto error = synthetic::compare_with_truth(local->model, scene);
    ASSERT_TRUE(error.ok());
    EXPECT_LT(error->max_position, 0.05);
}

TEST(ExtendLocally, JoinsAModelWithoutCommonPointsOnceSomeOfItsImagesAreThere) {
    const SyntheticScene scene = noisy_wall(8);
    std::vector<ImageId> second;
    for (std::uint32_t image = 16; image < kImages; ++image) second.push_back(ImageId{image});
    ClusterProblem problem = problem_without(scene, second);
    problem.recycled.push_back(without_points_beyond(
        synthetic::true_reconstruction(scene, synthetic::random_gauge(6), second),
        pairs_of(problem)));
    SolveOptions options = locally_from(10);
    options.policy.full_adjustment.again_when_grown_by = 1.0;
    const auto local = extended(problem, options);
    ASSERT_TRUE(local);
    EXPECT_EQ(local->statistics.joined_models, 1U);
    EXPECT_EQ(local->statistics.left_models, 0U);
    EXPECT_EQ(local->statistics.registered, 5U) << "the others come with the model";
    EXPECT_EQ(local->model.images.size(), kImages);
    const auto error = synthetic::compare_with_truth(local->model, scene);
    ASSERT_TRUE(error.ok());
    EXPECT_LT(error->max_position, 0.05);
}

TEST(ExtendLocally, LeavesWhatConcernsAllToASolveOfAll) {
    const SyntheticScene scene = noisy_wall(5);
    const ClusterProblem problem = problem_without(scene, {kNew});
    ASSERT_TRUE(extended(problem, locally_from(20)));
    EXPECT_FALSE(extended(problem, SolveOptions{})) << "not a large model";
    EXPECT_FALSE(extended(problem, locally_from(kImages))) << "a small model";
    ClusterProblem settling = problem;
    settling.settle = true;
    EXPECT_FALSE(extended(settling, locally_from(20)));
    ClusterProblem grown = problem;
    grown.recycled_state.images_at_full_adjustment = 20;
    EXPECT_FALSE(extended(grown, locally_from(20))) << "all of it is to be adjusted";
    // The adjustment was of more images than the model still has: five of 30 are more than a tenth.
    ClusterProblem split =
        problem_without(scene, {kNew, ImageId{11}, ImageId{12}, ImageId{13}, ImageId{15}});
    SolveOptions options = locally_from(20);
    options.policy.full_adjustment.again_when_grown_by = 0.1;
    split.recycled_state.images_at_full_adjustment = 60;
    EXPECT_FALSE(extended(split, options)) << "images that have left do not stand in for others";
    options.policy.full_adjustment.again_when_grown_by = 0.3;
    const auto extension = extended(split, options);
    ASSERT_TRUE(extension);
    EXPECT_EQ(extension->state.images_at_full_adjustment, 25U);
    // Two are new, so that the cluster is larger than its model even without one that has left.
    ClusterProblem left = problem_without(scene, {kNew, ImageId{27}});
    ASSERT_TRUE(extended(left, locally_from(20)));
    std::erase_if(left.images, [](const ClusterImage& image) { return image.id == kFar; });
    std::vector<VerifiedPairPtr> pairs = pairs_of(left);
    std::erase_if(pairs, [](const VerifiedPairPtr& pair) { return pair->pair.first == kFar; });
    left.view_graph = ViewGraph(pairs);
    EXPECT_FALSE(extended(left, locally_from(20))) << "an image has left";
}

TEST(ExtendLocally, LeavesABadConfigurationToASolveOfAll) {
    const SyntheticScene scene = noisy_wall(6);
    ClusterProblem problem = problem_without(scene, {kNew});
    Reconstruction folded = *problem.recycled.front();
    const Eigen::Quaterniond turn(
        Eigen::AngleAxisd(20.0 * std::numbers::pi / 180.0, Eigen::Vector3d::UnitY()));
    for (RegisteredImage& image : folded.images) {
        if (image.image > kNew) image.cam_from_cluster.rotation *= turn;
    }
    problem.recycled = {std::make_shared<const Reconstruction>(folded)};
    EXPECT_FALSE(extended(problem, locally_from(20)));
    problem.recycled_state.tolerated_contradiction_deg = 20.0;
    problem.recycled_state.images_at_contradiction = kImages;
    EXPECT_TRUE(extended(problem, locally_from(20))) << "it is known, and nothing else was better";
}

TEST(ExtendLocally, AsksOfPlacesWhereAnImageStandsBesideStrangers) {
    const SyntheticScene street = synthetic::make_scene(synthetic::line_along_wall(kImages), 7);
    const SyntheticScene folded = two_streets(kImages, 0.4, 7);
    const auto asks = [](const SyntheticScene& scene, const PlaceOptions& options) {
        const Reconstruction model =
            synthetic::true_reconstruction(scene, synthetic::random_gauge(3));
        return std::ranges::count_if(model.images, [&](const RegisteredImage& image) {
            return may_show_another_place(model, model.points, std::span(&image.image, 1), options);
        });
    };
    EXPECT_EQ(asks(street, {}), 0);
    EXPECT_GE(asks(folded, {}), kImages / 3) << "all whose neighbours see no copied facade";
    PlaceOptions off;
    off.min_contradictions = 0;
    EXPECT_EQ(asks(folded, off), 0) << "switched off";
}

TEST(ExtendLocally, AsksALargeModelOfPlacesOnlyWhenItHasChanged) {
    const SyntheticScene scene = noisy_wall(8);
    ClusterProblem problem = problem_without(scene, {kNew});
    problem.recycled_state.has_strangers = true;
    const auto asks = [&](std::uint32_t asked_with, std::uint32_t at_once_up_to) {
        problem.recycled_state.images_at_places = asked_with;
        SolveOptions options = locally_from(20);
        options.policy.affordable_up_to = at_once_up_to;
        options.policy.places.again_when_grown_by = 0.1;
        const auto attempt = extended(problem, options);
        EXPECT_TRUE(attempt && attempt->state.has_strangers) << "not forgotten before it is asked";
        return attempt && !attempt->places;
    };
    EXPECT_FALSE(asks(28, kImages - 1)) << "two images are less than a tenth";
    EXPECT_TRUE(asks(27, kImages - 1));
    EXPECT_FALSE(asks(33, kImages - 1)) << "images that have left count, too";
    EXPECT_TRUE(asks(34, kImages - 1));
    EXPECT_TRUE(asks(28, kImages)) << "a small model is asked at once";

    problem.recycled_state.images_at_places = 20;
    const auto solved = solve_cluster(problem, locally_from(20));
    ASSERT_TRUE(solved.ok());
    EXPECT_EQ(solved->state.images_at_places, kImages);
    EXPECT_FALSE(solved->state.has_strangers) << "it has been asked, and shows one place";
}

TEST(ExtendLocally, RemembersStrangersBesideALargeModelsNewImage) {
    const SyntheticScene folded = two_streets(kImages, 0.4, 7);
    SolveOptions options = locally_from(20);
    options.policy.affordable_up_to = 10;
    std::uint32_t extensions = 0;
    std::uint32_t strangers = 0;
    for (std::uint32_t i = 0; i < kImages; ++i) {
        ClusterProblem problem = problem_without(folded, {ImageId{i}});
        problem.recycled_state.images_at_places = kImages - 1;
        options.policy.places.again_when_grown_by = 1.0;
        const auto later = extended(problem, options);
        if (!later) continue;
        ++extensions;
        ASSERT_TRUE(later->places) << "not asked before it has doubled";
        options.policy.places.again_when_grown_by = 0.0;
        const auto now = extended(problem, options);
        EXPECT_EQ(!now->places, later->state.has_strangers);
        if (later->state.has_strangers) ++strangers;
    }
    EXPECT_GE(extensions, kImages / 2);
    EXPECT_GE(strangers, extensions / 4);
}

}  // namespace
}  // namespace psfm
