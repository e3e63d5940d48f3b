// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/clustering/host_cluster.h"

#include <gtest/gtest.h>

#include "stages/clustering/update_clustering.h"

namespace psfm {
namespace {

constexpr std::uint32_t kMuMin = 5;

ImageId image(std::uint32_t i) {
    return static_cast<ImageId>(i);
}

/// Two dense groups of six, 0-5 and 6-11, and further images without edges.
class HostClusterTest : public testing::Test {
  protected:
    HostClusterTest() {
        for (int i = 0; i < 16; ++i) graph.add_node();
        for (std::uint32_t group : {0U, 6U}) {
            for (std::uint32_t i = group; i < group + 6; ++i) {
                for (std::uint32_t j = group; j < i; ++j) graph.add_edge(image(j), image(i), 200);
            }
        }
    }
    void cluster() {
        std::vector<ImageId> all;
        for (std::uint32_t i = 0; i < graph.size(); ++i) all.push_back(image(i));
        update_clustering(clustering, graph, all, {});
    }
    std::optional<ClusterId> host(std::uint32_t i) const {
        return host_cluster(graph, clustering, image(i), kMuMin);
    }
    ClusterId cluster_of(std::uint32_t i) const { return clustering.cluster_of[i]; }

    ViewGraph graph;
    ClusteringState clustering;
};

TEST_F(HostClusterTest, ALeafIsAGuestOfTheClusterItHangsOn) {
    graph.add_edge(image(2), image(12), 60);
    cluster();
    ASSERT_NE(cluster_of(12), cluster_of(2)) << "its Jaccard distance is large";
    EXPECT_EQ(host(12), cluster_of(2));
    EXPECT_EQ(host(13), std::nullopt) << "no edges, no host";
    EXPECT_EQ(host(2), std::nullopt) << "members of large clusters are at home";
}

TEST_F(HostClusterTest, TheClusterWithMoreCorrespondencesWins) {
    graph.add_edge(image(0), image(12), 40);
    graph.add_edge(image(7), image(12), 30);
    graph.add_edge(image(8), image(12), 30);
    cluster();
    EXPECT_EQ(host(12), cluster_of(7));
}

TEST_F(HostClusterTest, OnlyLargeClustersAreHosts) {
    graph.add_edge(image(12), image(13), 500);
    graph.add_edge(image(0), image(13), 30);
    cluster();
    EXPECT_EQ(host(13), cluster_of(0));
    EXPECT_EQ(host(12), std::nullopt) << "its only neighbour is in a small cluster";
}

TEST_F(HostClusterTest, AChangedImageAsksForItselfAndItsSmallNeighbours) {
    graph.add_edge(image(2), image(12), 60);
    cluster();
    const std::vector<ImageId> changed{image(2)};
    EXPECT_EQ(images_to_host_again(graph, clustering, changed, kMuMin),
              (std::vector<ImageId>{image(2), image(12)}));
}

}  // namespace
}  // namespace psfm
