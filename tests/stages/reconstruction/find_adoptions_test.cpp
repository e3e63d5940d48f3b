// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/find_adoptions.h"

#include <gtest/gtest.h>

#include "tests/stages/merge/cut_scene.h"

namespace psfm {
namespace {

constexpr ImageId kStray{5};  // beside the second cluster

/// Two clusters of a ring; one image of the first is in no model. The first has kept only a few of
/// its points.
struct StrayImage {
    test::CutScene cut = test::cut_ring({6, 6}, 5);
    MergeProblem problem = cut.problem();
    UnplacedImage stray;

    explicit StrayImage(std::size_t points_of_first) {
        Reconstruction first = cut.model(0);
        std::erase_if(first.images, [](const auto& image) { return image.image == kStray; });
        for (ScenePoint& point : first.points)
            std::erase_if(point.track, [](const auto& o) { return o.image == kStray; });
        std::erase_if(first.points, [](const auto& point) { return point.track.size() < 2; });
        problem.clusters[0].model = std::make_shared<const Reconstruction>(first);
        merged = *run_merge(problem, {});
        // Taken away after the merge, which needs them.
        first.points.resize(std::min(first.points.size(), points_of_first));
        problem.clusters[0].model = std::make_shared<const Reconstruction>(first);

        const synthetic::SceneImage& image = cut.scene.images[index_of(kStray)];
        stray.id = kStray;
        stray.tried_by = ClusterId{0};
        stray.camera_id = image.camera;
        stray.camera = cut.scene.cameras.at(image.camera);
        stray.keypoints = std::make_shared<const Keypoints>(image.keypoints);
        for (const VerifiedPairPtr& pair : cut.pairs) {
            if (pair->pair.first != kStray && pair->pair.second != kStray) continue;
            const ImageId other = pair->pair.first == kStray ? pair->pair.second : pair->pair.first;
            stray.edges.push_back({pair, ClusterId{index_of(other) < 6 ? 0U : 1U}});
        }
    }

    void weaken_edges_to_second() {
        for (UnplacedImage::Edge& edge : stray.edges) {
            if (edge.cluster == ClusterId{0}) continue;
            VerifiedPair weak = *edge.pair;
            weak.geometry.inliers.resize(std::min<std::size_t>(weak.geometry.inliers.size(), 40));
            edge.pair = std::make_shared<const VerifiedPair>(weak);
        }
    }

    std::vector<Adoption> adoptions() const {
        return find_adoptions(problem, merged, std::span(&stray, 1), {});
    }

    MergeResult merged;
};

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
