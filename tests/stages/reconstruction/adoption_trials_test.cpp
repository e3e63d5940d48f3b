// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/adoption_trials.h"

#include <gtest/gtest.h>

#include "tests/stages/reconstruction/stray_image.h"

namespace psfm {
namespace {

using test::StrayImage;

/// An image that was tried once, in vain: it sees most of the cluster that tried it. Then the
/// cluster loses its points, without a new revision unless a test gives it one.
class AdoptionTrialsTest : public testing::Test {
  protected:
    AdoptionTrialsTest() {
        before_.weaken_edges_to_second();
        EXPECT_TRUE(find(before_).empty());
        EXPECT_EQ(trials_.tried(), 1U);
        now_ = before_;
        now_.problem.clusters[0].model = StrayImage(10).problem.clusters[0].model;
    }

    std::vector<Adoption> find(const StrayImage& stray) {
        return trials_.find(stray.problem, stray.merged, std::span(&stray.stray, 1), {});
    }

    AdoptionTrials trials_;
    StrayImage before_{1'000'000};
    StrayImage now_{10};
};

TEST_F(AdoptionTrialsTest, AreNotRepeatedWhileNothingHasChanged) {
    EXPECT_TRUE(find(before_).empty());
    EXPECT_EQ(trials_.tried(), 0U);
    ASSERT_EQ(now_.adoptions().size(), 1U) << "would be adopted, if it were tried";
    EXPECT_TRUE(find(now_).empty());
    EXPECT_EQ(trials_.tried(), 0U);
}

TEST_F(AdoptionTrialsTest, AreRepeatedForANewModel) {
    ++now_.problem.clusters[0].revision;
    EXPECT_EQ(find(now_).size(), 1U);
    EXPECT_EQ(trials_.tried(), 1U);
}

TEST_F(AdoptionTrialsTest, AreRepeatedWhenTheClustersStandOtherwise) {
    now_.merged.placements[1].world_from_cluster.translation.x() += 1e-9;
    EXPECT_EQ(find(now_).size(), 1U);
    now_ = before_;
    for (ClusterPlacement& placement : now_.merged.placements) placement.effective_cluster ^= 1U;
    find(now_);
    EXPECT_EQ(trials_.tried(), 1U);
}

TEST_F(AdoptionTrialsTest, AreRepeatedWhenAnEdgeGoes) {
    now_.stray.edges.pop_back();
    find(now_);
    EXPECT_EQ(trials_.tried(), 1U);
}

TEST_F(AdoptionTrialsTest, AreRepeatedForAnotherClusterThatTried) {
    now_.stray.tried_by = ClusterId{7};
    find(now_);
    EXPECT_EQ(trials_.tried(), 1U);
}

TEST_F(AdoptionTrialsTest, AreRepeatedAfterAnAdoptionThatCameToNothing) {
    ++now_.problem.clusters[0].revision;
    EXPECT_EQ(find(now_).size(), 1U);
    EXPECT_EQ(find(now_).size(), 1U);
}

TEST_F(AdoptionTrialsTest, ForgetImagesThatHaveAPlace) {
    EXPECT_TRUE(trials_.find(before_.problem, before_.merged, {}, {}).empty());
    find(before_);
    EXPECT_EQ(trials_.tried(), 1U);
}

TEST_F(AdoptionTrialsTest, SeeOneClusterAloneWhereverTheMergePutsIt) {
    std::erase_if(before_.stray.edges,
                  [](const auto& edge) { return edge.cluster != ClusterId{1}; });
    for (UnplacedImage::Edge& edge : before_.stray.edges) {
        VerifiedPair few = *edge.pair;
        few.geometry.inliers.resize(2);
        edge.pair = std::make_shared<const VerifiedPair>(few);
    }
    EXPECT_TRUE(find(before_).empty());
    EXPECT_EQ(trials_.tried(), 1U);
    before_.merged.placements[1].world_from_cluster.translation.x() += 0.5;
    find(before_);
    EXPECT_EQ(trials_.tried(), 0U);
}

}  // namespace
}  // namespace psfm
