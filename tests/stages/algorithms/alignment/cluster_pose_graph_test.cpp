// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/alignment/cluster_pose_graph.h"

#include <gtest/gtest.h>

#include "tests/stages/merge/cut_scene.h"
#include "tests/synthetic/rng.h"

namespace psfm {
namespace {

struct Planted {
    std::vector<Sim3> frame_from_cluster;
    std::vector<PoseGraphEdge> edges;

    void connect(std::uint32_t a, std::uint32_t b, double weight = 100.0) {
        PoseGraphEdge edge{a, b, inverse(frame_from_cluster[b]) * frame_from_cluster[a]};
        // Evidence lies around the middle of the frame, wherever the clusters' origins are.
        edge.anchor_in_a = inverse(frame_from_cluster[a]).translation;
        edge.extent_in_a = 5.0 / frame_from_cluster[a].scale;
        edge.weight = weight;
        edges.push_back(edge);
    }
    double error(const ClusterPoses& poses, std::uint32_t a, std::uint32_t b) const {
        PoseGraphEdge edge{a, b, inverse(frame_from_cluster[b]) * frame_from_cluster[a]};
        edge.anchor_in_a = inverse(frame_from_cluster[a]).translation;
        edge.extent_in_a = 5.0 / frame_from_cluster[a].scale;
        return pose_graph_residual(edge, poses.component_from_cluster[a],
                                   poses.component_from_cluster[b]);
    }
};

Planted random_poses(std::size_t count, std::uint64_t seed) {
    Planted planted;
    for (std::size_t k = 0; k < count; ++k) {
        planted.frame_from_cluster.push_back(synthetic::random_gauge(synthetic::mix_seed(seed, k)));
    }
    return planted;
}

/// A similarity near the identity about the anchor of an edge.
void disturb(PoseGraphEdge& edge, double amount, synthetic::Rng& rng) {
    Sim3 wrong;
    wrong.rotation = rng.small_rotation(amount);
    wrong.scale = std::exp(amount * rng.normal());
    wrong.translation = edge.anchor_in_a - wrong.scale * (wrong.rotation * edge.anchor_in_a) +
                        amount * edge.extent_in_a * rng.normal3();
    edge.b_from_a = edge.b_from_a * wrong;
}

ClusterPoses solve(const Planted& planted, const PoseGraphOptions& options = {}) {
    const std::vector<std::size_t> sizes(planted.frame_from_cluster.size(), 10);
    auto poses = solve_cluster_poses(planted.edges, sizes, options);
    EXPECT_TRUE(poses.ok());
    return poses.ok() ? *poses : ClusterPoses{};
}

TEST(ClusterPoseGraph, IsExactWithoutNoise) {
    Planted planted = random_poses(6, 1);
    for (std::uint32_t a = 0; a < 6; ++a) {
        for (std::uint32_t b = a + 1; b < 6; ++b) planted.connect(a, b);
    }
    const ClusterPoses poses = solve(planted);
    for (std::uint32_t b = 1; b < 6; ++b) EXPECT_LT(planted.error(poses, 0, b), 1e-7);
    EXPECT_EQ(poses.component_count, 1U);
}

TEST(ClusterPoseGraph, AveragesNoise) {
    Planted planted = random_poses(8, 2);
    for (std::uint32_t a = 0; a < 8; ++a) {
        for (std::uint32_t b = a + 1; b < 8; ++b) planted.connect(a, b);
    }
    synthetic::Rng rng(3);
    for (PoseGraphEdge& edge : planted.edges) disturb(edge, 0.005, rng);
    const ClusterPoses poses = solve(planted);
    for (std::uint32_t b = 1; b < 8; ++b) EXPECT_LT(planted.error(poses, 0, b), 0.02);
}

Planted two_way_ring(double mistake, std::uint64_t seed) {
    Planted planted = random_poses(8, seed);
    for (std::uint32_t k = 0; k < 8; ++k) {
        planted.connect(k, (k + 1) % 8);
        planted.connect(k, (k + 2) % 8);
    }
    synthetic::Rng rng(seed);
    planted.edges[0].weight = 150.0;  // the spanning tree believes it
    disturb(planted.edges[0], mistake, rng);
    return planted;
}

TEST(ClusterPoseGraph, HuberHoldsABadConstraintDown) {
    PoseGraphOptions huber_alone;
    huber_alone.max_residual = 1e9;
    PoseGraphOptions squares = huber_alone;
    squares.huber_scale = 1e9;
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        const Planted planted = two_way_ring(0.3, seed);
        const auto largest = [&](const PoseGraphOptions& options) {
            const ClusterPoses poses = solve(planted, options);
            double error = 0.0;
            for (std::uint32_t b = 1; b < 8; ++b)
                error = std::max(error, planted.error(poses, 0, b));
            return error;
        };
        EXPECT_LT(largest(huber_alone), 0.1) << seed;
        EXPECT_LT(largest(huber_alone), 0.5 * largest(squares)) << seed;
    }
}

TEST(ClusterPoseGraph, DropsWhatTheOthersContradict) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        const Planted planted = two_way_ring(1.0, seed);
        const ClusterPoses poses = solve(planted);
        EXPECT_FALSE(poses.used[0]);
        for (std::uint32_t b = 1; b < 8; ++b) EXPECT_LT(planted.error(poses, 0, b), 1e-6) << seed;
    }
}

TEST(ClusterPoseGraph, ABadConstraintInOneLoopIsTheWeakestOne) {
    Planted planted = random_poses(6, 4);
    for (std::uint32_t k = 0; k < 6; ++k) planted.connect(k, (k + 1) % 6);
    synthetic::Rng rng(5);
    planted.edges[3].weight = 20.0;
    disturb(planted.edges[3], 1.0, rng);
    const ClusterPoses poses = solve(planted);
    EXPECT_EQ(std::ranges::count(poses.used, false), 1);
    EXPECT_FALSE(poses.used[3]);
    for (std::uint32_t b = 1; b < 6; ++b) EXPECT_LT(planted.error(poses, 0, b), 1e-6);
}

TEST(ClusterPoseGraph, NeverDropsTheOnlyConnection) {
    Planted planted = random_poses(3, 6);
    planted.connect(0, 1);
    planted.connect(1, 2);
    PoseGraphOptions options;
    options.max_residual = 1e-12;
    const ClusterPoses poses = solve(planted, options);
    EXPECT_EQ(std::ranges::count(poses.used, true), 2);
    EXPECT_EQ(poses.component_count, 1U);
}

TEST(ClusterPoseGraph, ComponentsHaveTheirLargestClustersFrame) {
    Planted planted = random_poses(5, 7);
    planted.connect(0, 3);
    planted.connect(1, 2);
    const std::vector<std::size_t> sizes{5, 9, 9, 7, 1};
    auto poses = solve_cluster_poses(planted.edges, sizes, {});
    ASSERT_TRUE(poses.ok());
    EXPECT_EQ(poses->component, (std::vector<std::uint32_t>{0, 1, 1, 0, 2}));
    for (const std::uint32_t root : {3U, 1U, 4U}) {
        EXPECT_LT(test::difference(poses->component_from_cluster[root], Sim3{}), 1e-15);
    }
    EXPECT_TRUE(solve_cluster_poses({}, {}, {}).ok());
}

TEST(ClusterPoseGraph, IsRefinedFromWhereTheClustersAre) {
    Planted planted = random_poses(6, 8);
    for (std::uint32_t a = 0; a < 6; ++a) {
        for (std::uint32_t b = a + 1; b < 6; ++b) planted.connect(a, b);
    }
    std::vector<Sim3> start = planted.frame_from_cluster;
    synthetic::Rng rng(9);
    for (std::size_t k = 1; k < start.size(); ++k) {
        Sim3 moved{1.0, rng.small_rotation(0.05), 0.1 * rng.normal3()};
        start[k] = start[k] * moved;
    }
    const std::vector<std::size_t> sizes(start.size(), 10);
    auto refined = refine_cluster_poses(planted.edges, sizes, start, {});
    ASSERT_TRUE(refined.ok());
    for (std::size_t k = 0; k < start.size(); ++k)
        EXPECT_LT(test::difference((*refined)[k], planted.frame_from_cluster[k]), 1e-6) << k;
    EXPECT_TRUE(refine_cluster_poses({}, {}, {}, {}).ok());
}

}  // namespace
}  // namespace psfm
