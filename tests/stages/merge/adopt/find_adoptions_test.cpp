// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/merge/adopt/find_adoptions.h"

#include <gtest/gtest.h>

#include "tests/stages/reconstruction/stray_image.h"

namespace psfm {
namespace {

using test::kStray;
using test::StrayImage;

TEST(FindAdoptions, GivesAnImageToTheClusterWhosePointsItSees) {
    const StrayImage stray(10);
    ASSERT_EQ(stray.merged.effective_clusters, 1U);
    const auto adoptions = stray.adoptions();
    ASSERT_EQ(adoptions.size(), 1U);
    EXPECT_EQ(adoptions[0].image, kStray);
    EXPECT_EQ(adoptions[0].host, ClusterId{1});
    EXPECT_GE(adoptions[0].inliers_of_host, 20U);
    EXPECT_GT(adoptions[0].inliers, adoptions[0].inliers_of_host)
        << "the first cluster's few points agree in the merged frame";
}

TEST(FindAdoptions, LeavesAnImageThatSeesMostOfItsOwnCluster) {
    StrayImage stray(1'000'000);
    stray.weaken_edges_to_second();
    EXPECT_TRUE(stray.adoptions().empty());
}

TEST(FindAdoptions, LeavesAnImageWhosePoseMostEdgesContradict) {
    StrayImage stray(10);
    stray.weaken_edges_to_second();
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitY()));
    double to_first = 0.0;
    double to_second = 0.0;
    for (UnplacedImage::Edge& edge : stray.stray.edges) {
        const auto weight = static_cast<double>(edge.pair->geometry.inliers.size());
        (edge.cluster == ClusterId{0} ? to_first : to_second) += weight;
        if (edge.cluster != ClusterId{0}) continue;
        VerifiedPair turned = *edge.pair;
        turned.geometry.cam2_from_cam1.rotation = turn * turned.geometry.cam2_from_cam1.rotation;
        edge.pair = std::make_shared<const VerifiedPair>(turned);
    }
    ASSERT_GT(to_first, to_second) << "its own cluster's edges are the stronger ones";
    EXPECT_TRUE(stray.adoptions().empty());
    stray.stray.camera.focal_source = FocalSource::kUnknown;
    EXPECT_EQ(stray.adoptions().size(), 1U) << "rotations that nobody knows do not vote";
}

TEST(FindAdoptions, WantsPointsOfOneClusterThatCarryAPoseAlone) {
    StrayImage stray(10);
    for (UnplacedImage::Edge& edge : stray.stray.edges) {
        if (edge.cluster == ClusterId{0}) continue;
        VerifiedPair few = *edge.pair;
        few.geometry.inliers.resize(2);
        edge.pair = std::make_shared<const VerifiedPair>(few);
    }
    EXPECT_TRUE(stray.adoptions().empty());
}

TEST(FindAdoptions, KnowsOfNothingWithoutOtherClusters) {
    StrayImage stray(10);
    std::erase_if(stray.stray.edges, [](const auto& edge) { return edge.cluster != ClusterId{0}; });
    EXPECT_TRUE(stray.adoptions().empty());
    EXPECT_TRUE(find_adoptions(stray.problem, stray.merged, {}, {}).empty());
}

}  // namespace
}  // namespace psfm
