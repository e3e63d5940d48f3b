// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/model/cluster_problem.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "stages/reconstruction/model/surroundings.h"
#include "stages/reconstruction/solve/solve_cluster.h"
#include "tests/stages/reconstruction/problems.h"
#include "tests/synthetic/verified_pairs.h"

namespace psfm {
namespace {

constexpr std::array kElsewhere{ImageId{0}, ImageId{7}, ImageId{20}, ImageId{29}};

/// A wall of which some images are in other clusters; the view graph is of all.
ClusterProblem part_of_wall() {
    const auto scene = synthetic::make_scene(synthetic::line_along_wall(30), 3);
    ClusterProblem problem = problem_of(scene, synthetic::make_verified_pairs(scene));
    std::erase_if(problem.images, [](const ClusterImage& image) {
        return std::ranges::binary_search(kElsewhere, image.id);
    });
    std::vector<ImageId> known;
    for (const ClusterImage& image : problem.images) {
        if (image.id != ImageId{14}) known.push_back(image.id);
    }
    problem.recycled = {std::make_shared<const Reconstruction>(
        synthetic::true_reconstruction(scene, Sim3{}, known))};
    return problem;
}

/// The same, of a session that has no other images.
ClusterProblem alone(ClusterProblem problem) {
    problem.view_graph = ViewGraph(pairs_of(problem));
    return problem;
}

TEST(PairsOf, AreTheEdgesWithBothEndsInTheCluster) {
    const auto scene = synthetic::make_scene(synthetic::line_along_wall(30), 3);
    const auto all = synthetic::make_verified_pairs(scene);
    EXPECT_EQ(pairs_of(problem_of(scene, all)), all);
    std::vector<VerifiedPairPtr> expected = all;
    std::erase_if(expected, [](const VerifiedPairPtr& pair) {
        return std::ranges::binary_search(kElsewhere, pair->pair.first) ||
               std::ranges::binary_search(kElsewhere, pair->pair.second);
    });
    const auto pairs = pairs_of(part_of_wall());
    ASSERT_LT(expected.size(), all.size());
    EXPECT_TRUE(std::ranges::equal(pairs, expected, [](const auto& a, const auto& b) {
        return a->pair == b->pair && a->geometry.inliers == b->geometry.inliers;
    }));
    EXPECT_TRUE(pairs_of(ClusterProblem{}).empty());
    ClusterProblem nowhere = part_of_wall();
    nowhere.view_graph = {};
    EXPECT_TRUE(pairs_of(nowhere).empty()) << "its images are no nodes";
}

TEST(PairsOf, ImagesOfOtherClustersChangeNoSurroundings) {
    const ClusterProblem problem = part_of_wall();
    const auto with = surroundings_of_new_images(problem, SolveOptions{}.max_surroundings);
    const auto without =
        surroundings_of_new_images(alone(problem), SolveOptions{}.max_surroundings);
    ASSERT_TRUE(with && without);
    EXPECT_EQ(with->is_inside, without->is_inside);
    EXPECT_TRUE(std::ranges::equal(with->problem.images, without->problem.images, {},
                                   &ClusterImage::id, &ClusterImage::id));
    EXPECT_FALSE(pairs_of(with->problem).empty());
    EXPECT_EQ(pairs_of(with->problem), pairs_of(without->problem));
}

TEST(PairsOf, ImagesOfOtherClustersChangeNoSolution) {
    ClusterProblem problem = part_of_wall();
    for (const std::size_t recycled : {1U, 0U}) {
        problem.recycled.resize(recycled);
        const auto with = solve_cluster(problem, {});
        const auto without = solve_cluster(alone(problem), {});
        ASSERT_TRUE(with.ok() && without.ok());
        EXPECT_EQ(with->statistics.kind, without->statistics.kind);
        EXPECT_GE(with->model->images.size(), 18U) << "most of them";
        EXPECT_TRUE(std::ranges::equal(
            with->model->images, without->model->images, [](const auto& a, const auto& b) {
                return a.image == b.image &&
                       a.cam_from_cluster.translation == b.cam_from_cluster.translation;
            }));
        EXPECT_TRUE(std::ranges::equal(with->model->points, without->model->points,
                                       [](const auto& a, const auto& b) {
                                           return a.position == b.position && a.track == b.track;
                                       }));
    }
}

}  // namespace
}  // namespace psfm
