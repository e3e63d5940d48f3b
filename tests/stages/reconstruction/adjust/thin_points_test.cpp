// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/adjust/thin_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <memory>
#include <random>

#include "stages/reconstruction/build/refine_model.h"
#include "stages/reconstruction/model/tracks.h"
#include "tests/stages/reconstruction/problems.h"
#include "tests/synthetic/compare.h"
#include "tests/synthetic/disturb.h"
#include "tests/synthetic/verified_pairs.h"

namespace psfm {
namespace {

using synthetic::SyntheticScene;

std::vector<ImageId> ids_of(const ClusterProblem& problem) {
    std::vector<ImageId> ids;
    for (const ClusterImage& image : problem.images) ids.push_back(image.id);
    return ids;
}

/// The true model of a ring of cameras, to be disturbed.
struct RingModel {
    SyntheticScene scene;
    ClusterProblem problem;
    std::unique_ptr<CorrespondenceGraph> matches;
    std::unique_ptr<WorkingModel> model;

    explicit RingModel(double noise_px) {
        scene = synthetic::make_scene(synthetic::ring_around_sphere(12), 3);
        if (noise_px > 0.0) scene = synthetic::add_pixel_noise(scene, noise_px, 4);
        problem = problem_of(scene, synthetic::make_verified_pairs(scene));
        std::vector<std::uint32_t> counts;
        for (const ClusterImage& image : problem.images)
            counts.push_back(static_cast<std::uint32_t>(image.keypoints->size()));
        matches = std::make_unique<CorrespondenceGraph>(ids_of(problem), counts, pairs_of(problem));
        model = std::make_unique<WorkingModel>(problem, *matches);
        model->load(synthetic::true_reconstruction(scene, Sim3{}, ids_of(problem)));
    }
};

std::vector<std::uint32_t> observations(const WorkingModel& model,
                                        const std::vector<std::uint32_t>& points) {
    std::vector<std::uint32_t> counts(model.image_count(), 0);
    for (const std::uint32_t point : points) {
        for (const WorkingModel::Feature& feature : model.points()[point].track)
            ++counts[feature.image];
    }
    return counts;
}

TEST(CoveringPoints, ServesEveryImageWithFewPoints) {
    const RingModel ring(0.0);
    constexpr std::uint32_t kWanted = 40;
    const auto few = covering_points(*ring.model, {}, kWanted);
    EXPECT_TRUE(std::ranges::is_sorted(few));
    EXPECT_LT(4 * few.size(), ring.model->alive_points());
    for (const std::uint32_t count : observations(*ring.model, few))
        EXPECT_GE(count, kWanted * 9 / 10);
    EXPECT_EQ(covering_points(*ring.model, {}, 1'000'000).size(), ring.model->alive_points());
    EXPECT_TRUE(covering_points(*ring.model, {}, 0).empty());
}

TEST(CoveringPoints, ServesOnlyTheImagesThatAreAskedFor) {
    const RingModel ring(0.0);
    const std::vector<std::uint32_t> region{2, 3, 4};
    const auto few = covering_points(*ring.model, region, 40);
    const auto served = observations(*ring.model, few);
    for (const std::uint32_t image : region) EXPECT_GE(served[image], 36U);
    EXPECT_LT(few.size(), covering_points(*ring.model, {}, 40).size());
    const auto seen = points_seen_by(*ring.model, region);
    EXPECT_TRUE(std::ranges::includes(seen, few));
    EXPECT_EQ(covering_points(*ring.model, region, 1'000'000).size(),
              static_cast<std::size_t>(std::ranges::count_if(
                  seen,
                  [&](std::uint32_t point) {
                      const auto& track = ring.model->points()[point].track;
                      return std::ranges::count_if(track, [](const auto& feature) {
                                 return feature.image >= 2 && feature.image <= 4;
                             }) >= 2;
                  })))
        << "a point that one of them sees holds nothing together";
}

TEST(RefinePoints, FindsThePointsAndLeavesOthersAlone) {
    const RingModel ring(0.0);
    std::vector<Eigen::Vector3d> truth;
    std::mt19937_64 rng(5);
    std::normal_distribution<double> normal;
    for (std::uint32_t point = 0; point < ring.model->points().size(); ++point) {
        truth.push_back(ring.model->points()[point].position);
        ring.model->set_position(
            point, truth.back() + 0.02 * Eigen::Vector3d(normal(rng), normal(rng), normal(rng)));
    }
    const std::vector<std::uint32_t> except{0, 2};
    std::vector<std::uint32_t> moving;
    std::ranges::set_difference(points_seen_by(*ring.model, {}), except,
                                std::back_inserter(moving));
    const Eigen::Vector3d disturbed = ring.model->points()[2].position;
    AdjustmentOptions options;
    options.function_tolerance = 1e-12;
    refine_points(*ring.model, moving, options);
    EXPECT_EQ(ring.model->points()[2].position, disturbed);
    for (std::uint32_t point = 0; point < truth.size(); ++point) {
        if (std::ranges::binary_search(except, point)) continue;
        EXPECT_LT((ring.model->points()[point].position - truth[point]).norm(), 1e-6) << point;
    }
}

TEST(RefinePoints, IsWhatAnAdjustmentOfPointsAloneDoes) {
    const RingModel ours(0.5);
    const RingModel ceres(0.5);
    AdjustmentOptions options;
    options.function_tolerance = 1e-10;
    refine_points(*ours.model, points_seen_by(*ours.model, {}), options);
    AdjustmentScope scope = full_scope(*ceres.model, false);
    scope.free_images.clear();
    scope.gauge.reset();
    ASSERT_TRUE(adjust(*ceres.model, scope, options).ok());
    for (std::uint32_t point = 0; point < ours.model->points().size(); ++point) {
        EXPECT_LT(
            (ours.model->points()[point].position - ceres.model->points()[point].position).norm(),
            1e-4);
    }
}

TEST(Adjust, LeavesPointsAloneThatAreNotChosen) {
    const RingModel whole(0.5);
    const RingModel thinned(0.5);
    const AdjustmentScope all = full_scope(*whole.model, false);
    AdjustmentScope few = all;
    few.points = covering_points(*thinned.model, {}, 40);
    std::vector<Eigen::Vector3d> before;
    for (const WorkingModel::Point& point : thinned.model->points())
        before.push_back(point.position);
    const auto with_all = adjust(*whole.model, all, {});
    const auto with_few = adjust(*thinned.model, few, {});
    ASSERT_TRUE(with_all.ok() && with_few.ok());
    std::size_t seen = 0;
    for (const std::uint32_t count : observations(*thinned.model, *few.points)) seen += count;
    EXPECT_EQ(with_few->residuals, seen);
    EXPECT_LT(2 * with_few->residuals, with_all->residuals);
    for (std::uint32_t point = 0; point < before.size(); ++point) {
        EXPECT_EQ(thinned.model->points()[point].position != before[point],
                  std::ranges::binary_search(*few.points, point))
            << point;
    }
}

/// A ring whose cameras were moved by about a centimetre, adjusted.
std::unique_ptr<RingModel> refined_ring(const RefinementOptions& refinement) {
    auto ring = std::make_unique<RingModel>(0.5);
    std::mt19937_64 rng(6);
    std::normal_distribution<double> normal;
    for (std::uint32_t image = 0; image < ring->model->image_count(); ++image) {
        Rigid3 pose = ring->model->pose(image);
        pose.translation += 0.01 * Eigen::Vector3d(normal(rng), normal(rng), normal(rng));
        ring->model->set_pose(image, pose);
    }
    EXPECT_TRUE(
        refine_model(*ring->model, refinement, {.options = SolveOptions{}, .fix_intrinsics = true})
            .ok());
    return ring;
}

double max_position_error(const RingModel& ring) {
    const auto compared = synthetic::compare_with_truth(ring.model->save(), ring.scene);
    EXPECT_TRUE(compared.ok());
    return compared.ok() ? compared->max_position : std::numeric_limits<double>::infinity();
}

TEST(RefineModel, ThinnedIsNearlyAsGoodAsWhole) {
    RefinementOptions refinement = SolveOptions{}.growth;
    refinement.points_per_image = 0;
    const double whole = max_position_error(*refined_ring(refinement));
    refinement.points_per_image = 300;
    refinement.thin_from_images = 12;
    const double thinned = max_position_error(*refined_ring(refinement));
    EXPECT_GT(whole, 0.0);
    EXPECT_NE(thinned, whole);
    EXPECT_LT(thinned, 2.5 * whole);
    EXPECT_LT(thinned, 0.02);  // of a ring of 8 m radius
    refinement.thin_from_images = 13;
    EXPECT_EQ(max_position_error(*refined_ring(refinement)), whole) << "too small to be thinned";
}

}  // namespace
}  // namespace psfm
