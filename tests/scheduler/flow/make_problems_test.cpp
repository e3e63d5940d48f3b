// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/flow/make_problems.h"

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <vector>

#include "tests/scheduler/session/made_up_clusters.h"

namespace psfm {
namespace {

constexpr double kExifFocal = 1000.0;
constexpr double kTrueFocal = 740.0;

Camera with_focal(double focal_px) {
    return make_camera(1024, 768, focal_px, FocalSource::kExif);
}

/// Images first … last-1 of camera 0, all placed with the given focal length, or none of them.
ClusterEntry cluster_of(std::uint32_t id, std::uint32_t first, std::uint32_t last,
                        std::optional<double> solved_focal) {
    ClusterEntry entry;
    entry.id = ClusterId{id};
    entry.membership.topology = 1;
    Reconstruction model;
    for (std::uint32_t i = first; i < last; ++i) {
        entry.membership.members.push_back(ImageId{i});
        model.images.push_back({ImageId{i}, CameraId{0}, {}});
    }
    if (solved_focal) {
        model.cameras[CameraId{0}] = with_focal(*solved_focal);
        entry.published.topology = 1;
        entry.published.model = std::make_shared<const Reconstruction>(std::move(model));
        entry.material.models = {{entry.id, 1, entry.published.model}};
    }
    return entry;
}

/// Makes these the clusters of a state; nobody is a guest but who is adopted.
void put_clusters(SessionState& state, const std::vector<ClusterEntry>& clusters,
                  const std::map<ImageId, ClusterId>& adopted = {}) {
    ImageHosts hosts = test::hosts_of(clusters);
    for (const auto& [image, host] : adopted) hosts.adopt(image, host);
    state.clusters = ClusterTable(5, clusters, std::move(hosts));
}

std::vector<ClusterEntry> clusters_of(const SessionState& state) {
    std::vector<ClusterEntry> clusters;
    for (const auto& [id, entry] : state.clusters.entries()) clusters.push_back(entry);
    return clusters;
}

SessionState state_of(const std::vector<ClusterEntry>& clusters) {
    SessionState state(5);
    std::uint32_t images = 0;
    auto scene = std::make_shared<Scene>();
    for (const ClusterEntry& entry : clusters) {
        auto shown = std::make_shared<SceneCluster>();
        shown->id = entry.id;
        shown->model = entry.published.model;
        scene->clusters.push_back(std::move(shown));
        images += static_cast<std::uint32_t>(entry.membership.members.size());
    }
    put_clusters(state, clusters);
    for (std::uint32_t i = 0; i < images; ++i) {
        Image image;
        image.id = ImageId{i};
        image.camera = CameraId{0};
        state.photographs.images.push_back(image);
        state.photographs.keypoints.push_back(std::make_shared<const Keypoints>());
        state.view_graph.add_node();
    }
    state.photographs.cameras[CameraId{0}] = with_focal(kExifFocal);
    state.scene = std::move(scene);
    return state;
}

std::shared_ptr<const ClusterProblem> problem_of(const SessionState& state, std::uint32_t cluster,
                                                 bool fix_intrinsics = false) {
    SessionConfig config;
    config.fix_intrinsics = fix_intrinsics;
    return make_cluster_problem(state, config, SolveOptions{},
                                state.clusters.entries().at(ClusterId{cluster}), false);
}

TEST(MakeClusterProblem, StartsFromWhatTheLargestModelKnowsOfACamera) {
    const SessionState state =
        state_of({cluster_of(0, 0, 12, 700.0), cluster_of(1, 12, 32, kTrueFocal),
                  cluster_of(2, 32, 37, std::nullopt)});
    const auto problem = problem_of(state, 2);
    EXPECT_EQ(problem->cameras.at(CameraId{0}).fx(), kExifFocal) << "as accepted";
    ASSERT_TRUE(problem->calibrated.contains(CameraId{0}));
    EXPECT_EQ(problem->calibrated.at(CameraId{0}).fx(), kTrueFocal);
}

TEST(MakeClusterProblem, KeepsWhatItsOwnModelKnows) {
    const SessionState state =
        state_of({cluster_of(0, 0, 30, kTrueFocal), cluster_of(1, 30, 36, 760.0)});
    EXPECT_TRUE(problem_of(state, 1)->calibrated.empty());
}

TEST(MakeClusterProblem, DoesNotTrustSmallModelsOrTouchGivenIntrinsics) {
    const SessionState small =
        state_of({cluster_of(0, 0, 9, kTrueFocal), cluster_of(1, 9, 14, std::nullopt)});
    EXPECT_TRUE(problem_of(small, 1)->calibrated.empty());
    const SessionState large =
        state_of({cluster_of(0, 0, 30, kTrueFocal), cluster_of(1, 30, 35, std::nullopt)});
    EXPECT_TRUE(problem_of(large, 1, true)->calibrated.empty());
}

/// Two placed clusters, and an image of the first that it cannot place; with edges to both.
SessionState state_with_stray() {
    ClusterEntry first = cluster_of(0, 0, 6, kTrueFocal);
    first.membership.members.push_back(ImageId{6});
    first.published.revision = 1;
    ClusterEntry second = cluster_of(1, 7, 13, kTrueFocal);
    second.published.revision = 1;
    SessionState state = state_of({first, second});
    for (const std::uint32_t other : {3U, 8U}) {
        const ImagePair pair = ImagePair::of(ImageId{6}, ImageId{other});
        state.view_graph.add_edge(pair.first, pair.second, 1.0,
                                  std::make_shared<const VerifiedPair>(VerifiedPair{pair, {}}));
    }
    return state;
}

TEST(UnplacedImages, AreThoseThatAnotherClusterMayKnow) {
    SessionState state = state_with_stray();
    const auto unplaced = unplaced_images(state, {});
    ASSERT_EQ(unplaced.size(), 1U);
    EXPECT_EQ(unplaced[0].id, ImageId{6});
    EXPECT_EQ(unplaced[0].tried_by, ClusterId{0});
    ASSERT_EQ(unplaced[0].edges.size(), 2U);
    EXPECT_EQ(unplaced[0].edges[0].cluster, ClusterId{0});
    EXPECT_EQ(unplaced[0].edges[1].cluster, ClusterId{1});
}

TEST(UnplacedImages, AreNotTriedAgainOnceAdopted) {
    SessionState state = state_with_stray();
    put_clusters(state, clusters_of(state), {{ImageId{6}, ClusterId{1}}});
    // Its host has not placed it yet, or never will: no third one is asked meanwhile.
    EXPECT_TRUE(unplaced_images(state, {}).empty());
}

/// The last version shows clusters as they are.
void publish(SessionState& state) {
    auto scene = std::make_shared<Scene>();
    for (const auto& [id, entry] : state.clusters.entries()) {
        auto shown = std::make_shared<SceneCluster>();
        shown->id = id;
        shown->revision = entry.published.revision;
        shown->model = entry.published.model;
        scene->clusters.push_back(std::move(shown));
    }
    state.scene = std::move(scene);
}

TEST(UnplacedImages, AreTriedAgainWhenWhatTheySeeWasSolvedAgain) {
    SessionState state = state_with_stray();
    publish(state);
    EXPECT_TRUE(unplaced_images(state, {}).empty());
    for (const std::uint32_t solved : {0U, 1U}) {
        publish(state);
        std::vector<ClusterEntry> clusters = clusters_of(state);
        ++clusters[solved].published.revision;
        put_clusters(state, clusters);
        EXPECT_EQ(unplaced_images(state, {}).size(), 1U) << "cluster " << solved;
    }
    publish(state);
    ClusterEntry third = cluster_of(2, 13, 19, kTrueFocal);
    third.published.revision = 1;
    std::vector<ClusterEntry> clusters = clusters_of(state);
    clusters.push_back(third);
    put_clusters(state, clusters);
    EXPECT_TRUE(unplaced_images(state, {}).empty()) << "it sees nothing of that";
}

}  // namespace
}  // namespace psfm
