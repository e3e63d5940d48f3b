// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/merge/run_merge.h"

#include <gtest/gtest.h>

#include "stages/merge/geo/keep_frame.h"
#include "stages/merge/values/model_cameras.h"
#include "tests/stages/merge/cut_scene.h"

namespace psfm {
namespace {

using test::CutScene;

MergeResult merged(const MergeProblem& problem, const MergeOptions& options = {}) {
    auto result = run_merge(problem, options);
    EXPECT_TRUE(result.ok()) << result.error().message;
    return result.ok() ? *result : MergeResult{};
}

/// Largest distance of camera centres from where the truth, moved by one similarity, has them, in
/// units of the median distance of neighbours.
double largest_error(const CutScene& cut, const MergeResult& result,
                     const std::vector<std::size_t>& clusters) {
    const std::size_t root = clusters.front();
    const Sim3 placed_from_true =
        result.placements[root].world_from_cluster * cut.cluster_from_world[root];
    double largest = 0.0;
    for (const std::size_t c : clusters) {
        const Sim3 world_from_true =
            result.placements[c].world_from_cluster * cut.cluster_from_world[c];
        for (const ImageId image : cut.members[c]) {
            const Eigen::Vector3d centre =
                cut.scene.images[index_of(image)].cam_from_world.target_origin_in_source();
            largest =
                std::max(largest, (world_from_true * centre - placed_from_true * centre).norm());
        }
    }
    return largest;
}

TEST(RunMerge, PutsAllClustersIntoOneFrame) {
    const CutScene cut = test::cut_ring({12, 15, 10, 11}, 1);
    const MergeProblem problem = cut.problem();
    ASSERT_GE(problem.pairs.size(), 4U);  // the loop is closed
    const MergeResult result = merged(problem);
    EXPECT_EQ(result.effective_clusters, 1U);
    EXPECT_LT(largest_error(cut, result, {0, 1, 2, 3}), 1e-6);
    EXPECT_EQ(result.reused, 0U);
    EXPECT_EQ(result.dropped, 0U);
}

TEST(RunMerge, ANewFrameHasTheLargestClustersGaugeAndUnitSpacing) {
    const CutScene cut = test::cut_ring({12, 15, 10, 11}, 1);
    const MergeResult result = merged(cut.problem());
    const Sim3& root = result.placements[1].world_from_cluster;
    EXPECT_LT(rotation_angle(root.rotation), 1e-12);
    EXPECT_LT(root.translation.norm(), 1e-12);
    std::vector<Eigen::Vector3d> centres;
    for (std::size_t c = 0; c < 4; ++c) {
        for (const RegisteredImage& image : cut.model(c).images) {
            centres.push_back(result.placements[c].world_from_cluster *
                              image.cam_from_cluster.target_origin_in_source());
        }
    }
    EXPECT_NEAR(median_neighbor_distance(centres), 1.0, 1e-6);
}

TEST(RunMerge, WithoutEdgesEachClusterIsOneByItself) {
    const CutScene cut = test::cut_ring({8, 12, 9}, 2);
    MergeProblem problem = cut.problem();
    problem.pairs.clear();
    problem.clusters.push_back({ClusterId{7}, 0, nullptr});
    problem.clusters.push_back({ClusterId{9}, 1, std::make_shared<const Reconstruction>()});
    const MergeResult result = merged(problem);
    EXPECT_EQ(result.effective_clusters, 3U);
    ASSERT_EQ(result.placements.size(), 5U);
    const std::vector<std::uint32_t> expected{2, 0, 1, 3,
                                              4};  // most images first, unsolved ones last
    for (std::size_t k = 0; k < 5; ++k) {
        EXPECT_EQ(result.placements[k].id, problem.clusters[k].id);
        EXPECT_EQ(result.placements[k].effective_cluster, expected[k]);
    }
}

TEST(RunMerge, ComponentsAreNumberedByPlacedImages) {
    const CutScene cut = test::cut_ring({20, 12, 13}, 3);
    MergeProblem problem = cut.problem();
    std::erase_if(problem.pairs,
                  [](const ClusterPairEdgesPtr& pair) { return pair->a == ClusterId{0}; });
    const MergeResult result = merged(problem);
    EXPECT_EQ(result.effective_clusters, 2U);
    EXPECT_EQ(result.placements[0].effective_cluster, 1U);  // 20 against 25
    EXPECT_EQ(result.placements[1].effective_cluster, 0U);
    EXPECT_EQ(result.placements[2].effective_cluster, 0U);
}

TEST(RunMerge, TheFrameDoesNotJump) {
    CutScene cut = test::cut_ring({12, 15, 10, 11}, 4);
    MergeProblem problem = cut.problem();
    const MergeResult before = merged(problem);
    MergeProblem next = cut.problem();
    next.previous = test::publish(problem, before);
    // The largest cluster was solved anew in another gauge, and another one is the largest now.
    cut.cluster_from_world[1] = synthetic::random_gauge(99);
    next.clusters[1] = cut.cluster(1, 2);
    cut.members[1].resize(5);
    next.clusters[1].model = std::make_shared<const Reconstruction>(cut.model(1));
    next.known = before.constraints;
    const MergeResult after = merged(next);
    EXPECT_EQ(after.effective_clusters, 1U);
    const auto published = published_poses(*next.previous);
    for (std::size_t c = 0; c < 4; ++c) {
        for (const RegisteredImage& image : next.clusters[c].model->images) {
            const Eigen::Vector3d now = after.placements[c].world_from_cluster *
                                        image.cam_from_cluster.target_origin_in_source();
            EXPECT_LT((now - published.at(image.image).target_origin_in_source()).norm(), 1e-5);
        }
    }
}

TEST(RunMerge, TwoFramesThatJoinTakeTheLargerOnes) {
    const CutScene cut = test::cut_ring({20, 12, 13}, 5);
    MergeProblem problem = cut.problem();
    std::erase_if(problem.pairs,
                  [](const ClusterPairEdgesPtr& pair) { return pair->a == ClusterId{0}; });
    const MergeResult apart = merged(problem);
    MergeProblem next = cut.problem();
    next.previous = test::publish(problem, apart);
    next.known = apart.constraints;
    const MergeResult joined = merged(next);
    EXPECT_EQ(joined.effective_clusters, 1U);
    EXPECT_EQ(joined.reused, 1U);
    EXPECT_LT(test::difference(joined.placements[1].world_from_cluster,
                               apart.placements[1].world_from_cluster),
              1e-5);
    EXPECT_GT(test::difference(joined.placements[0].world_from_cluster,
                               apart.placements[0].world_from_cluster),
              1e-2);
    // And apart again: each part stays where it was.
    MergeProblem last = problem;
    last.previous = test::publish(next, joined);
    const MergeResult again = merged(last);
    EXPECT_EQ(again.effective_clusters, 2U);
    for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_LT(test::difference(again.placements[c].world_from_cluster,
                                   joined.placements[c].world_from_cluster),
                  1e-5);
    }
}

TEST(RunMerge, OnlyWhatChangedIsEstimatedAgain) {
    const CutScene cut = test::cut_ring({12, 15, 10, 11}, 6);
    MergeProblem problem = cut.problem();
    const MergeResult first = merged(problem);
    problem.known = first.constraints;
    const MergeResult same = merged(problem);
    EXPECT_EQ(same.reused, problem.pairs.size());
    for (std::size_t c = 0; c < 4; ++c) {
        EXPECT_EQ(same.placements[c].world_from_cluster.translation,
                  first.placements[c].world_from_cluster.translation);
    }
    problem.clusters[2].revision = 2;
    const auto with_2 = std::ranges::count_if(problem.pairs, [](const ClusterPairEdgesPtr& pair) {
        return pair->a == ClusterId{2} || pair->b == ClusterId{2};
    });
    EXPECT_EQ(merged(problem).reused, problem.pairs.size() - static_cast<std::size_t>(with_2));
    problem.clusters[2].revision = 1;
    problem.pairs[0] = test::without_last_edge(*problem.pairs[0]);
    EXPECT_EQ(merged(problem).reused, problem.pairs.size() - 1);
}

TEST(RunMerge, LooksAtThePointsOfClustersThatChangedAndOfTheirNeighborsOnly) {
    const CutScene cut = test::cut_ring({12, 15, 10, 11}, 6);
    MergeProblem problem = cut.problem();
    EXPECT_EQ(clusters_to_look_into(problem).size(), 4U);
    MergeResult first = merged(problem);
    problem.known = first.constraints;
    EXPECT_TRUE(clusters_to_look_into(problem).empty());
    std::erase_if(problem.pairs, [](const ClusterPairEdgesPtr& pair) {
        return pair->a == ClusterId{0} && pair->b == ClusterId{2};
    });
    problem.clusters[0].revision = 2;
    for (const ClusterPairEdgesPtr& pair : problem.pairs)
        ASSERT_FALSE(pair->a == ClusterId{0} && pair->b == ClusterId{2});
    const auto asked = clusters_to_look_into(problem);
    EXPECT_EQ(asked, (std::vector{ClusterId{0}, ClusterId{1}, ClusterId{3}}));
    const MergeResult whole = merged(problem);

    ASSERT_EQ(first.cameras.size(), 4U);
    for (std::size_t c = 0; c < 4; ++c) {
        EXPECT_EQ(first.cameras[c].first, problem.clusters[c].id);
        EXPECT_EQ(first.cameras[c].second->depths, mean_depths(*problem.clusters[c].model));
        problem.clusters[c].cameras = first.cameras[c].second;
    }
    auto poses = std::make_shared<Reconstruction>(*problem.clusters[2].model);
    poses->points = {};
    problem.clusters[2].model = poses;
    const MergeResult without = merged(problem);
    for (std::size_t c = 0; c < 4; ++c) {
        EXPECT_EQ(without.placements[c].world_from_cluster.translation,
                  whole.placements[c].world_from_cluster.translation);
        EXPECT_EQ(without.cameras[c].second, first.cameras[c].second);
    }
}

/// A cluster whose model is not shown for one version.
TEST(RunMerge, WhatIsKnownOfAClusterWithoutAModelIsSetAside) {
    const CutScene cut = test::cut_ring({12, 15, 10, 11}, 8);
    MergeProblem problem = cut.problem();
    const MergeResult first = merged(problem);
    problem.known = first.constraints;
    const std::shared_ptr<const Reconstruction> model = problem.clusters[1].model;
    problem.clusters[1].model = nullptr;
    const MergeResult without = merged(problem);
    ASSERT_FALSE(without.set_aside.empty());
    EXPECT_EQ(without.constraints.size() + without.set_aside.size(), first.constraints.size());
    for (const ClusterConstraint& constraint : without.set_aside) EXPECT_FALSE(constraint.used);

    problem.known = without.constraints;
    problem.known.insert(problem.known.end(), without.set_aside.begin(), without.set_aside.end());
    problem.clusters[1].model = model;
    const MergeResult with = merged(problem);
    EXPECT_EQ(with.reused, problem.pairs.size());
    EXPECT_TRUE(with.set_aside.empty());
    for (std::size_t c = 0; c < 4; ++c) {
        EXPECT_EQ(with.placements[c].world_from_cluster.translation,
                  first.placements[c].world_from_cluster.translation);
    }
    // A cluster that is gone takes it along.
    std::erase_if(problem.pairs, [](const ClusterPairEdgesPtr& pair) {
        return pair->a == ClusterId{1} || pair->b == ClusterId{1};
    });
    problem.clusters.erase(problem.clusters.begin() + 1);
    EXPECT_TRUE(merged(problem).set_aside.empty());
}

TEST(RunMerge, IsBitwiseRepeatable) {
    const CutScene cut = test::cut_ring({12, 15, 10, 11}, 7);
    const MergeResult first = merged(cut.problem());
    const MergeResult second = merged(cut.problem());
    for (std::size_t c = 0; c < 4; ++c) {
        const Sim3& x = first.placements[c].world_from_cluster;
        const Sim3& y = second.placements[c].world_from_cluster;
        EXPECT_EQ(x.scale, y.scale);
        EXPECT_EQ(x.rotation.coeffs(), y.rotation.coeffs());
        EXPECT_EQ(x.translation, y.translation);
    }
}

TEST(RunMerge, GaugesAndOrderOfImagesDoNotMatter) {
    const std::vector<std::uint32_t> sizes{12, 15, 10};
    const synthetic::SyntheticScene scene =
        synthetic::make_scene(synthetic::ring_around_sphere(37), 8);
    const CutScene cut = test::cut(scene, sizes, 8);
    // Backwards: the same clusters, every pair the other way round.
    std::vector<std::size_t> order;
    for (std::size_t k = 37; k > 0; --k) order.push_back(k - 1);
    CutScene reversed = test::cut(synthetic::reorder_images(scene, order), {10, 15, 12}, 80);
    EXPECT_LT(largest_error(cut, merged(cut.problem()), {0, 1, 2}), 1e-6);
    EXPECT_LT(largest_error(reversed, merged(reversed.problem()), {0, 1, 2}), 1e-6);
}

TEST(RunMerge, RefusesBadProblems) {
    const CutScene cut = test::cut_ring({12, 12}, 9);
    const auto refused = [](const MergeProblem& problem, const MergeOptions& options = {}) {
        auto result = run_merge(problem, options);
        return !result.ok() && result.error().code == ErrorCode::kInvalidArgument;
    };
    const MergeProblem good = cut.problem();
    EXPECT_FALSE(refused(good));
    EXPECT_FALSE(refused({}));
    MergeProblem bad = good;
    std::swap(bad.clusters[0], bad.clusters[1]);
    EXPECT_TRUE(refused(bad));
    bad = good;
    bad.pairs[0] = cluster_pair_edges(good.pairs[0]->b, good.pairs[0]->a, good.pairs[0]->edges);
    EXPECT_TRUE(refused(bad));
    bad = good;
    bad.pairs.push_back(bad.pairs[0]);
    EXPECT_TRUE(refused(bad));
    bad = good;
    bad.pairs[0] = cluster_pair_edges(good.pairs[0]->a, ClusterId{5}, good.pairs[0]->edges);
    EXPECT_TRUE(refused(bad));
    MergeOptions options;
    options.constraint.min_neighborhood_similarity = 2.0;
    EXPECT_TRUE(refused(good, options));
    options = {};
    options.pose_graph.huber_scale = 0.0;
    EXPECT_TRUE(refused(good, options));
}

}  // namespace
}  // namespace psfm
