// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/alignment/rigid_groups.h"

#include <gtest/gtest.h>

#include "tests/synthetic/rng.h"

namespace psfm {
namespace {

PoseGraphEdge edge_of(std::uint32_t a, std::uint32_t b, double weight) {
    PoseGraphEdge edge;
    edge.a = a;
    edge.b = b;
    edge.weight = weight;
    return edge;
}

/// A walk of some images, each with edges to the next two, the nearer the stronger.
std::vector<PoseGraphEdge> walk(std::uint32_t images) {
    std::vector<PoseGraphEdge> edges;
    for (std::uint32_t i = 0; i + 1 < images; ++i) {
        edges.push_back(edge_of(i, i + 1, 100.0 + i % 7));
        if (i + 2 < images) edges.push_back(edge_of(i, i + 2, 50.0));
    }
    return edges;
}

std::vector<std::uint8_t> nobody_alone(std::size_t images) {
    return std::vector<std::uint8_t>(images, 0);
}

TEST(RigidGroups, FollowTheStrongestEdges) {
    const std::vector<PoseGraphEdge> edges{edge_of(0, 1, 10.0), edge_of(1, 2, 30.0),
                                           edge_of(2, 3, 20.0), edge_of(3, 4, 40.0)};
    const RigidGroups groups = group_rigidly(edges, nobody_alone(6), 2);
    EXPECT_EQ(groups.group_of, (std::vector<std::uint32_t>{0, 1, 1, 2, 2, 3}));
    EXPECT_EQ(groups.sizes, (std::vector<std::size_t>{1, 2, 2, 1}));
}

TEST(RigidGroups, AreConnectedAndNoLargerThanAsked) {
    for (const std::size_t most : {1U, 2U, 5U, 16U, 1000U}) {
        const RigidGroups groups = group_rigidly(walk(200), nobody_alone(200), most);
        std::vector<std::vector<std::uint32_t>> members(groups.sizes.size());
        for (std::uint32_t i = 0; i < 200; ++i) members[groups.group_of[i]].push_back(i);
        for (std::size_t g = 0; g < members.size(); ++g) {
            EXPECT_EQ(members[g].size(), groups.sizes[g]);
            EXPECT_LE(members[g].size(), most);
            for (std::size_t k = 1; k < members[g].size(); ++k)
                EXPECT_LE(members[g][k] - members[g][k - 1], 2U) << "an edge leads on";
        }
        EXPECT_LE(groups.sizes.size(), most == 1 ? 200 : 1 + 2 * 200 / most);
    }
}

TEST(RigidGroups, LeaveThoseAloneThatAreToBe) {
    std::vector<std::uint8_t> is_alone(50, 0);
    for (const std::size_t image : {0U, 7U, 8U, 31U}) is_alone[image] = 1;
    const RigidGroups groups = group_rigidly(walk(50), is_alone, 16);
    for (const std::size_t image : {0U, 7U, 8U, 31U})
        EXPECT_EQ(groups.sizes[groups.group_of[image]], 1U) << image;
    EXPECT_LT(groups.sizes.size(), 20U) << "the others are in groups";
}

TEST(RigidGroups, KeepWhatEdgesSayBetweenThem) {
    const std::vector<PoseGraphEdge> edges = walk(60);
    const RigidGroups groups = group_rigidly(edges, nobody_alone(60), 16);
    const std::vector<PoseGraphEdge> between = groups.edges_between(edges);
    std::size_t next = 0;
    for (const PoseGraphEdge& edge : edges) {
        const std::uint32_t a = groups.group_of[edge.a];
        const std::uint32_t b = groups.group_of[edge.b];
        if (a == b) continue;
        ASSERT_LT(next, between.size());
        EXPECT_EQ(between[next].a, a);
        EXPECT_EQ(between[next].b, b);
        EXPECT_EQ(between[next++].weight, edge.weight);
    }
    EXPECT_EQ(next, between.size());
    std::vector<Sim3> poses(groups.sizes.size());
    for (std::size_t g = 0; g < poses.size(); ++g) poses[g].scale = static_cast<double>(g + 1);
    const std::vector<Sim3> by_node = groups.by_node(poses);
    for (std::size_t i = 0; i < 60; ++i) EXPECT_EQ(by_node[i].scale, groups.group_of[i] + 1.0);
}

/// Beside the definition: no edge is left between groups that together would not be too large.
TEST(RigidGroups, LeaveNoEdgeThatCouldHoldMoreTogether) {
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
        synthetic::Rng rng(seed);
        const std::size_t images = 2 + rng.below(60);
        std::vector<PoseGraphEdge> edges;
        for (std::size_t e = 0; e < 2 * images; ++e) {
            const auto a = static_cast<std::uint32_t>(rng.below(images));
            const auto b = static_cast<std::uint32_t>(rng.below(images));
            if (a != b) edges.push_back(edge_of(a, b, rng.uniform(1.0, 9.0)));
        }
        const std::size_t most = 1 + rng.below(12);
        const RigidGroups groups = group_rigidly(edges, nobody_alone(images), most);
        for (const PoseGraphEdge& edge : groups.edges_between(edges))
            EXPECT_GT(groups.sizes[edge.a] + groups.sizes[edge.b], most);
    }
}

}  // namespace
}  // namespace psfm
