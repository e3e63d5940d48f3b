// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Merging by way of run_merge(): which parts are solved again, and that it makes no difference.
#include "stages/merge/consistency/consistent_poses.h"

#include <gtest/gtest.h>

#include "tests/stages/merge/divided_town.h"

namespace psfm {
namespace {

using test::CutScene;

MergeResult merged(const MergeProblem& problem) {
    auto result = run_merge(problem, {});
    EXPECT_TRUE(result.ok()) << result.error().message;
    return result.ok() ? *result : MergeResult{};
}

void expect_same(const MergeResult& x, const MergeResult& y) {
    EXPECT_EQ(x.effective_clusters, y.effective_clusters);
    ASSERT_EQ(x.placements.size(), y.placements.size());
    for (std::size_t c = 0; c < x.placements.size(); ++c) {
        EXPECT_EQ(x.placements[c].effective_cluster, y.placements[c].effective_cluster);
        const Sim3& a = x.placements[c].world_from_cluster;
        const Sim3& b = y.placements[c].world_from_cluster;
        EXPECT_EQ(a.scale, b.scale);
        EXPECT_EQ(a.rotation.coeffs(), b.rotation.coeffs());
        EXPECT_EQ(a.translation, b.translation);
    }
    ASSERT_EQ(x.constraints.size(), y.constraints.size());
    for (std::size_t k = 0; k < x.constraints.size(); ++k)
        EXPECT_EQ(x.constraints[k].used, y.constraints[k].used);
}

/// Two parts of a ring: clusters 0 and 1, and 2 and 3.
MergeProblem two_parts() {
    MergeProblem problem = test::cut_ring({12, 15, 10, 11}, 6).problem();
    std::erase_if(problem.pairs, [](const ClusterPairEdgesPtr& pair) {
        return (pair->a < ClusterId{2}) != (pair->b < ClusterId{2});
    });
    return problem;
}

TEST(ConsistentPoses, OnlyPartsThatHaveChangedAreSolvedAgain) {
    MergeProblem problem = two_parts();
    const MergeResult first = merged(problem);
    EXPECT_EQ(first.effective_clusters, 2U);
    ASSERT_EQ(first.known_poses.parts.size(), 2U);
    EXPECT_EQ(first.parts_solved, 2U);
    problem.known_poses = first.known_poses;
    const MergeResult same = merged(problem);
    EXPECT_EQ(same.parts_solved, 0U);
    EXPECT_EQ(same.known_poses.parts, first.known_poses.parts);
    expect_same(same, first);

    problem.clusters[2].revision = 2;
    EXPECT_EQ(merged(problem).parts_solved, 1U);
    problem.clusters[2].revision = 1;
    problem.pairs.front() = test::without_last_edge(*problem.pairs.front());
    EXPECT_EQ(merged(problem).parts_solved, 1U);
    problem.pairs.erase(problem.pairs.begin());
    const MergeResult alone = merged(problem);
    EXPECT_EQ(alone.effective_clusters, 3U);
    EXPECT_EQ(alone.parts_solved, 0U) << "a cluster by itself is no part";
    EXPECT_EQ(alone.known_poses.parts.size(), 1U);
}

TEST(ConsistentPoses, PartsThatContradictThemselvesFallIntoGroupsThatAreKnownNextTime) {
    test::DividedTown town(600, 40, 0.4);
    const MergeResult first = merged(town.problem());
    const auto falls_apart = [](const SolvedPartPtr& part) { return !part->groups.empty(); };
    ASSERT_TRUE(std::ranges::any_of(first.known_poses.parts, falls_apart));
    const auto [wrong, used] = town.wrong_ones(first);
    EXPECT_LT(4 * wrong, used) << wrong << " of " << used << " are folds";
    EXPECT_GE(used, town.problem().clusters.size() / 2);
    town.take_over(first);
    EXPECT_EQ(merged(town.problem()).parts_solved, 0U);

    std::size_t solved = 0;
    std::size_t solved_without = 0;
    for (std::size_t changed = 0; changed < 3; ++changed) {
        town.change(5 * changed);
        const MergeResult with = merged(town.problem());
        MergeProblem without = town.problem();
        without.known_poses = {};
        ASSERT_FALSE(town.problem().known_poses.judgements->empty());
        const MergeResult anew = merged(without);
        expect_same(with, anew);
        solved += with.parts_solved;
        solved_without += anew.parts_solved;
        town.take_over(with);
    }
    EXPECT_LT(solved, solved_without) << "groups that the changed cluster is not in";
}

}  // namespace
}  // namespace psfm
